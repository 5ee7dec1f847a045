"""Commands that answer for several devices at once, from the store alone."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mfr_bench.decide.experiment import config_of, scene_of
from mfr_bench.decide.question import EXACT_ERROR, Question

from ..report import planted
from ..report.test_devices import device

TIMES = {"slow": {"ab-array": 8.0, "ab-ll": 9.0}, "fast": {"ab-array": 3.0, "ab-ll": 1.1}}
QUESTION = ("decide", "--size", "64x64", "--layers", "8")


@pytest.fixture
def two(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return [device(Path("out"), name, times) for name, times in TIMES.items()]


def test_a_table_over_devices_says_how_they_differ(mfr, two):
    ended = mfr("table", "out", "--devices")
    assert ended.status == 0 and "planted: 2 devices" in ended.out and "Rank on each device" in ended.out
    assert not (two[0].path / "tables").exists()
    assert mfr("table", "out", "--devices", "--json").status == 2


def test_advice_for_all_devices(mfr, two):
    cell = two[0].cells()[0]
    assert "rmse" in cell["values"]
    ended = mfr("advise", "out", "--max-error", "0.01", "--devices", "--json")
    found = json.loads(ended.out)
    assert ended.status == 0 and [each["best_on_worst"]["entry"] for each in found] == ["ab-ll", "ab-ll"]
    assert found[0]["near_on_all"][0]["worst_ratio"] == pytest.approx(9 / 8)
    assert mfr("advise", "out", "--max-error", "0.01", "--memory-mb", "1e-9", "--devices").status == 6
    alone = mfr("advise", "out/slow", "--max-error", "0.01", "--devices")
    assert alone.status == 2 and "no scene of these results was measured on several devices" in alone.err


def test_a_decision_for_all_devices_measures_nothing(mfr, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    question = Question((64, 64), 8, 1.0, None, EXACT_ERROR)
    name = config_of(question, scene_of(question), (), 1.0)["name"]
    for slug, times in TIMES.items():
        about = planted.DEVICE | {"slug": slug}
        cells = [planted.cell(method, time_ms=ms, device=about, values={"max_error_all": 0.0})
                 for method, ms in times.items()]
        planted.folder(Path("out", slug, name), cells, device=about, name=name)
    ended = mfr(*QUESTION, "--devices", "out")
    assert ended.status == 0 and "Best on the worst device: ab-ll" in ended.out, ended.err
    one = mfr(*QUESTION, "--devices", "out/slow")
    assert one.status == 2 and f"1 results of {name}" in one.err
