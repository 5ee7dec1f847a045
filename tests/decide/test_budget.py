"""The budget of an answer: it begins with the process, and sets time aside for its end; clocks are planted."""

import json
import sys
import time

import pytest

from mfr_bench import environment
from mfr_bench.decide import budget as budgets
from mfr_bench.decide.budget import Budget, budget
from mfr_bench.decide.model import enough_layers
from mfr_bench.environment import started

from ..cli.conftest import apart, here, sabotaged  # noqa: F401  fixtures
from ..methods.drawing import stack


@pytest.fixture
def clock(monkeypatch):
    """The time is what the test says."""
    now = [1000.0]
    monkeypatch.setattr(budgets.time, "monotonic", lambda: now[0])
    return now


def test_a_loaded_machine_gets_more_time_for_the_end(clock):
    quiet, loaded = Budget(1000.0, 120.0), Budget(1000.0, 120.0, slowness=6.0)
    assert quiet.stop == 1116.0 and quiet.last == 1118.5
    assert loaded.stop == 1096.0 and loaded.last == 1111.0
    assert Budget(1000.0, 10.0, slowness=20.0).stop == 1007.0  # no more than a share of it
    clock[0] = 1100.0
    assert quiet.left_s() == 16.0 and loaded.left_s() == 0.0


def test_what_would_not_end_in_time_has_no_room(clock):
    loaded = Budget(1000.0, 120.0, slowness=6.0)
    clock[0] = 1100.0
    assert loaded.room_for(1.8) and not loaded.room_for(2.0)


def test_the_start_of_the_process_counts_and_tells_how_loaded_the_machine_is(monkeypatch):
    for module in (budgets, environment):
        monkeypatch.setattr(module, "started", lambda: time.monotonic() - 9.0)
    monkeypatch.setattr(budgets.time, "process_time", lambda: 1.5)
    found = budget(60.0)
    assert found.slowness == pytest.approx(6.0, rel=0.05)
    assert found.stop < time.monotonic() + 60.0 - 9.0


def test_a_process_knows_when_it_started():
    begun = started()
    assert begun <= time.monotonic() - time.process_time() + 0.05
    assert started() == pytest.approx(begun, abs=0.2 + time.process_time() * (sys.platform != "linux"))


def test_a_model_that_has_no_time_left_names_a_number_that_is_enough():
    scene = stack([i / 16 for i in range(1, 13)], [(200, 100, 50, 80)] * 12)
    assert enough_layers(scene, 0.05, until=time.monotonic() - 1.0) == 12
    assert enough_layers(scene, 0.05) < 12


STUCK = """\
import sys, time
if "mfr_bench.run.worker" in " ".join(sys.orig_argv):
    import mfr_bench.run.cell as cell
    class Stuck(cell.Frame):
        def __init__(self, device, fitted, *more):
            if fitted.variant.method.id == "ab-ll":
                time.sleep(3600)
            super().__init__(device, fitted, *more)
    cell.Frame = Stuck
"""


def test_a_candidate_that_never_compiles_does_not_keep_the_answer_waiting(here, tmp_path):  # noqa: F811
    """The worker hangs in one candidate, within the limits of an ordinary cell: it is ended, and that is said.

    How many of the others can race afterwards is left to the machine.
    """
    ended = apart("decide", "--size", "24x20", "--layers", "5", "--time-budget", "20s", "--json",
                  env=sabotaged(tmp_path / "sabotage", STUCK))
    assert ended.status in (0, 1), ended.err  # 1: no candidate was measured in time
    answer = json.loads(ended.out)
    reason, = (entry["reason"] for entry in answer["excluded"] if entry["method"] == "ab-ll")
    assert reason.startswith("timeout: compile: no end within") or "within the time budget" in reason
    assert answer["method"] != "ab-ll"
