"""cluster.yaml: what is wrong in it is a line each, with what is allowed."""

import pytest

from mfr_bench.cluster.settings import read_cluster
from mfr_bench.errors import UsageError

GOOD = "engine: local\nstore: out\nkinds: {cpu: {shares: 2, device: cpu}}\n"


def lines_of(tmp_path, text):
    (tmp_path / "cluster.yaml").write_text(text)
    with pytest.raises(UsageError) as error:
        read_cluster(str(tmp_path / "cluster.yaml"))
    return error.value.lines


def test_the_store_stands_beside_the_file(tmp_path):
    (tmp_path / "cluster.yaml").write_text(GOOD)
    cluster, store = read_cluster(str(tmp_path / "cluster.yaml"))
    assert store == tmp_path / "out" and cluster.kinds["cpu"].shares == 2 and cluster.kinds["cpu"].minutes == 60


@pytest.mark.parametrize(("text", "said"), [
    (GOOD.replace("engine: local", "engine: pbs"), "engine: input should be 'slurm' or 'local'"),
    (GOOD.replace("shares: 2", "shares: 0"), "kinds.cpu.shares: input should be greater than or equal to 1"),
    (GOOD.replace("shares: 2", "share: 2"), "kinds.cpu.share: no such key; allowed: shares, device"),
    (GOOD.replace("store: out\n", ""), "store: field required"),
    (GOOD.replace("cpu: {", "../up: {"), "kinds: '../up'; allowed: letters"),
    (GOOD + "gres: 1\n", "gres: no such key; allowed: engine, store, setup, kinds"),
    ("[1, 2", "is no YAML"), ("kinds: {}\nengine: local\nstore: x\n", "kinds: dictionary should have at least 1"),
    ("", "the file: input should be"),
])
def test_a_mistake_is_a_line(tmp_path, text, said):
    (line,) = lines_of(tmp_path, text)
    assert line.startswith(f"{tmp_path / 'cluster.yaml'}: ") and said in line


def test_all_mistakes_at_once(tmp_path):
    assert len(lines_of(tmp_path, "engine: pbs\nkinds: {cpu: {minutes: -1}}\n")) == 3
