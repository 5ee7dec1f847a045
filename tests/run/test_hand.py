"""The limits of cells: what the harness does for itself counts to none of them, and has limits of its own."""

from __future__ import annotations

import pytest

from mfr_bench.config.model import Measure
from mfr_bench.run import device_process as processes
from mfr_bench.run.events import BETWEEN, Begun

from .acting import Actor, cell, finished, well


def test_what_comes_between_two_steps_is_no_time_of_the_method_and_has_a_limit_of_its_own(play, monkeypatch):
    now = [0.0]
    monkeypatch.setattr(processes.time, "monotonic", lambda: now[0])
    measure = Measure(time_limit_s=2, hard_limit_s=30)

    def later():
        now[0] += 4

    def steps(group):
        first, second = group.jobs
        turns = [event for _ in range(3) for event in (Begun(first.key, BETWEEN), *[later] * 20,
                                                       Begun(first.key, "sampling"), later)]
        return [*turns, Begun(first.key, BETWEEN), finished(first), Begun(second.key, BETWEEN), *[later] * 40]

    stage = play([cell(m, measure=measure) for m in ("floor", "ab-array")], Actor(steps), Actor(well))
    rows = stage.rows()
    assert rows["floor", 4]["status"] == "ok"
    assert (rows["ab-array", 4]["status"], rows["ab-array", 4]["reason"]) == (
        "timeout", "between two steps: no end within 120 s")


@pytest.mark.parametrize(("steps", "expected"), [(25, "ok"), (40, "timeout")])
def test_making_a_scene_is_no_time_of_its_cells(play, monkeypatch, steps, expected):
    """A scene of 2048x2048 takes longer, on a busy machine, than a cell of it may: no cell is to blame."""
    now = [0.0]
    monkeypatch.setattr(processes.time, "monotonic", lambda: now[0])
    measure = Measure(time_limit_s=1, hard_limit_s=3)

    def later():
        now[0] += 4

    def makes(group):
        return [Begun(None, "scene"), *[later] * steps, *(well(group) if expected == "ok" else [])]

    rows = play([cell(m, measure=measure) for m in ("floor", "ab-array")], Actor(makes), Actor(well)).rows()
    assert {(row["status"], row["reason"]) for row in rows.values()} == {
        (expected, None if expected == "ok" else "scene: no end within 120 s")}
