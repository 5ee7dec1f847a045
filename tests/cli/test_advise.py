"""`advise`: configs and folders that it takes, how it ends, and that it needs no OpenGL."""

import json

import pytest

from ..report import planted
from .conftest import TINY
from .test_report_commands import without_gl


def point(method, time_ms, rmse):
    return planted.cell(method, method, time_ms, values={"rmse": rmse, "flip": rmse, "max_error_all": rmse})


@pytest.fixture
def measured(tmp_path, monkeypatch):
    """A config, and its results where `run` writes them."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.yaml").write_text(TINY)
    (tmp_path / "empty").mkdir()
    planted.folder(tmp_path / "results" / "llvmpipe" / "tiny", [point("wboit", 1.0, 0.1), point("ab-array", 4.0, 1e-8)],
                   name="tiny")
    return tmp_path


@pytest.mark.parametrize("target", ["tiny.yaml", "results", "results/llvmpipe/tiny"])
def test_a_config_or_a_folder(measured, target):
    ended = without_gl("advise", target, "--max-error", "0.01", "--json")
    assert (ended.status, ended.err) == (0, "")
    record, = json.loads(ended.out)
    assert record["best"]["method"] == "ab-array"


@pytest.mark.parametrize(("error", "best"), [("1/5", "wboit"), ("1/255", "ab-array"), ("1e2/1e3", "wboit")])
def test_an_error_may_be_a_fraction(measured, error, best):
    ended = without_gl("advise", "tiny.yaml", "--max-error", error, "--json")
    assert ended.status == 0
    record, = json.loads(ended.out)
    assert record["best"]["method"] == best


def test_text_is_told_on_stdout(measured):
    ended = without_gl("advise", "tiny.yaml", "--max-error", "0.5", "--memory-mb", "64")
    assert ended.status == 0
    assert ended.out.startswith("tiny · llvmpipe: rmse at most 0.5, memory at most 64 MiB\nMeasured 2024-05-06: 64×64 ")
    assert any(line.startswith("wboit ") for line in ended.out.splitlines())


def test_limits_that_nothing_keeps_are_a_result(measured):
    ended = without_gl("advise", "tiny.yaml", "--max-error", "1e-12")
    assert ended.status == 6
    assert "Nothing measured keeps this. The least rmse is 1e-08: ab-array." in ended.out


def test_nothing_measured_says_what_to_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.yaml").write_text(TINY)
    ended = without_gl("advise", "tiny.yaml", "--max-error", "0.1")
    assert ended.status == 2
    assert ended.complaint == ("tiny.yaml: nothing is measured in results/*/tiny; run: mfr-bench run tiny.yaml, or "
                               "give the folder that it was measured into")


@pytest.mark.parametrize(("arguments", "says"), [
    (["tiny.yaml"], "Missing option '--max-error'; for example: mfr-bench advise pareto --max-error 0.01 --memory-mb "),
    (["tyni.yaml"], "tyni.yaml: no such file"),
    (["tiny.yaml", "--max-error", "0"], "'0' is not allowed; allowed: a number above 0, up to 1, or "),
    (["tiny.yaml", "--max-error", "2"], "'2' is not allowed; allowed: a number above 0, up to 1, or a fraction "),
    (["tiny.yaml", "--max-error", "256/255"], "'256/255' is not allowed; allowed: a number above 0, up to 1, or "),
    (["tiny.yaml", "--max-error", "1", "--memory-mb", "inf"], "'inf' is not allowed; allowed: a number above 0; "),
    (["tiny.yaml", "--max-error", "1/0"], "'1/0' is not allowed; allowed: a number above 0"),
    (["tiny.yaml", "--max-error", "1/"], "'1/' is not allowed; allowed: a number above 0"),
    (["tiny.yaml", "--max-error", "nan"], "'nan' is not allowed; allowed: a number above 0"),
    (["tiny.yaml", "--max-error", "1", "--memory-mb", "-3"], "'-3' is not allowed; allowed: a number above 0"),
    (["tiny.yaml", "--max-error", "1", "--metric", "rsme"],
     "'rsme' is not allowed; allowed: rmse, flip, max; nearest: 'rmse'"),
    (["tiny.yaml", "--max-error", "1", "--like", "nn=3"], "'nn=3' is not allowed; allowed: KEY=VALUE with KEY of size"),
    (["tiny.yaml", "--max-error", "1", "--scene", "size=12"], "size=12 is not allowed; allowed: WxH in pixels"),
    (["tyni.yaml", "--max-error", "1"], "tyni.yaml: no such file"),
    (["empty", "--max-error", "1"], "empty: no results in or below it; allowed: a folder that 'mfr-bench run' wrote"),
])
def test_mistakes_are_one_line(measured, arguments, says):
    ended = without_gl("advise", *arguments)
    assert ended.status == 2
    assert says in ended.complaint
