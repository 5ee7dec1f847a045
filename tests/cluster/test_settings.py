"""cluster.yaml: what is wrong in it is a line each, with what is allowed."""

from pathlib import Path

import pytest

from mfr_bench.cluster.settings import read_cluster
from mfr_bench.cluster.submission import _parameters
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


SLURM = GOOD.replace("local", "slurm")


def kind(text):
    return SLURM.replace("shares: 2", text)


@pytest.mark.parametrize(("text", "said"), [
    (GOOD.replace("engine: local", "engine: pbs"), "1: engine: input should be 'slurm' or 'local'"),
    (GOOD.replace("shares: 2", "shares: 0"), "3: kinds.cpu.shares: input should be greater than or equal to 1"),
    (GOOD.replace("shares: 2", "share: 2"), "3: kinds.cpu.share: no such key; allowed: shares, device"),
    (GOOD.replace("store: out\n", ""), "1: store: field required"),
    (GOOD.replace("cpu: {", "../up: {"), "3: kinds: '../up' is no name of a kind; allowed: letters"),
    (GOOD.replace("store: out", "store: 5"), "2: store: is no text on one line; allowed: one, in quotes"),
    (GOOD + "gres: 1\n", "4: gres: no such key; allowed: engine, store, setup, kinds"),
    (GOOD + "engine: slurm\n", "4: engine: the key is repeated, first on line 1"),
    (GOOD + "setup: [module load mesa]\n", "4: setup: is for Slurm; allowed: engine slurm, or to leave it out"),
    (GOOD.replace("shares: 2", "gres: gpu"), "3: kinds.cpu.gres: is for Slurm; allowed: engine slurm, or to leave"),
    (GOOD.replace("device: cpu", 'device: ["0", ""]'), "3: kinds.cpu.device: is no device; allowed: what"),
    (GOOD.replace("device: cpu", "device: []"), "3: kinds.cpu.device: is no device; allowed: what --device takes"),
    (GOOD.replace("shares: 2", "speed: .nan"), "3: kinds.cpu.speed: input should be less than or equal to"),
    (GOOD.replace("shares: 2", "minutes: 1:30"), "3: kinds.cpu.minutes: input should be a valid integer"),
    (kind('partition: ""'), "3: kinds.cpu.partition: is no text on one line; allowed: one, in quotes"),
    (kind("partition: 5"), "3: kinds.cpu.partition: is no text on one line; allowed: one, in quotes"),
    (kind('gres: "gpu:1\\n#SBATCH --uid=0"'), "3: kinds.cpu.gres: is no text on one line; allowed: one, in quotes"),
    (kind("memory_gb: 8G"), "3: kinds.cpu.memory_gb: input should be a valid number"),
    (kind("options: {time: 5}"), "3: kinds.cpu.options: time: allowed: the key minutes of the kind"),
    (kind("options: {cpus_per_task: 5}"), "cpus_per_task: allowed: the key cpus of the kind"),
    (kind("options: {array: 1-3}"), "3: kinds.cpu.options: array: is set by mfr-bench"),
    (kind("options: {a b: 1}"), "3: kinds.cpu.options: 'a b' is no option of sbatch"),
    (kind("options: {exclusive: false}"), "exclusive: allowed: a text on one line, a whole number, or true"),
    (kind("options: [exclusive]"), "3: kinds.cpu.options: is no mapping; allowed: options of sbatch"),
    ("[1, 2", "1: not valid YAML: "), ("a: " + "[" * 500, "1: nested or repeated too deeply"),
    ("a: &x [*x]\n", "1: nested or repeated too deeply"),
    ("kinds: {}\nengine: local\nstore: x\n", "1: kinds: dictionary should have at least 1"),
    ("engine: local\nstore: x\nkinds: {a: }\n", "3: kinds.a: is no mapping; allowed: one with keys shares, device"),
    ("", "1: is no mapping; allowed: one with keys engine, store, setup, kinds"),
])
def test_a_mistake_is_a_line(tmp_path, text, said):
    (line,) = lines_of(tmp_path, text)
    assert line.startswith(f"{tmp_path / 'cluster.yaml'}:") and said in line


def test_what_is_no_text_is_a_line(tmp_path):
    (tmp_path / "cluster.yaml").write_bytes(b"engine: \xff")
    with pytest.raises(UsageError, match=r"is no text in UTF-8; docs/machines\.md shows one"):
        read_cluster(str(tmp_path / "cluster.yaml"))


def test_every_key_reaches_the_engine(tmp_path):
    (tmp_path / "cluster.yaml").write_text(EVERY)
    cluster, store = read_cluster(str(tmp_path / "cluster.yaml"))
    assert store == Path.home() / "out" and cluster.kinds["cpu"].device == ["0"]
    asked = _parameters(cluster, cluster.kinds["gpu"])
    assert asked == {
        "name": "mfr-bench", "timeout_min": 90, "cpus_per_task": 4, "mem_gb": 8.5, "slurm_partition": "p",
        "slurm_gres": "gpu:h100:1", "slurm_constraint": "a&(b|c)", "slurm_account": "me", "slurm_qos": "low",
        "slurm_setup": ["module load mesa"], "slurm_signal_delay_s": 60,
        "slurm_additional_parameters": {"requeue": True, "nice": 100, "exclusive": True, "mail-type": "END"}}
    lines = executor_of(tmp_path, asked)
    for wanted in ("--partition=p", "--gres=gpu:h100:1", "--constraint='a&(b|c)'", "--account=me", "--qos=low",
                   "--time=90", "--cpus-per-task=4", "--nice=100", "--exclusive", "--mail-type=END", "--requeue",
                   "--signal=USR2@60"):
        assert f"#SBATCH {wanted}" in lines
    assert "module load mesa" in lines


EVERY = """\
engine: slurm
store: ~/out
setup: [module load mesa]
kinds:
  gpu: {shares: 2, device: [GPU-1, GPU-2], speed: 50, minutes: 90, cpus: 4, memory_gb: 8.5, partition: p,
        gres: "gpu:h100:1", constraint: "a&(b|c)", account: me, qos: low,
        options: {nice: 100, exclusive: true, mail-type: END}}
  cpu: {device: 0}
"""


def executor_of(tmp_path, asked):
    """The lines of the batch file that submitit hands to sbatch."""
    import submitit

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("submitit.slurm.slurm.SlurmExecutor.affinity", classmethod(lambda cls: 2))
        executor = submitit.AutoExecutor(folder=tmp_path / "logs", cluster="slurm")
    executor.update_parameters(**asked)
    return executor._executor._make_submission_file_text("true", "x").splitlines()


def test_all_mistakes_at_once(tmp_path):
    assert len(lines_of(tmp_path, "engine: pbs\nkinds: {cpu: {minutes: -1}}\n")) == 3
