"""A device that fails its self-tests: what it cannot be trusted to draw is unsupported, no fault of a method."""

from __future__ import annotations

import pytest

from mfr_bench.run import device_process as processes
from mfr_bench.run.events import Begun, Ended, Failed, Finished, Group, SelfTest, SelfTested, Synced
from mfr_bench.run.settling import final
from mfr_bench.run.trust import blame
from mfr_bench.store import failed_trials

from ..cli.conftest import apart, cells, sabotaged
from .acting import CELLS, CRASH, Actor, cell, finished, well

FAILING = {"blending": "3 of 9 ways right\nand six wrong", "queries": "0 samples counted"}
REASON = ("needs OpenGL as it is specified, which fails the trial 'blending' (3 of 9 ways right and six wrong) and 1 "
          "more; see mfr-bench doctor, and measure again once the device passes")
ALL = [*CELLS, cell("floor", n=9)]  # of two scenes, the small one first


def finds(failing):
    return Actor(lambda request: [SelfTested(failing)] if isinstance(request, SelfTest) else [])


def wrong(job):
    return Finished(job.key, "wrong", "max_abs_error 1 above 0.0001", {"time_ms": 1.0, "timer": "wall"})


def draws_nothing(group):
    """The first cell is right, the second is wrong, and so is whatever follows."""
    first, *others = group.jobs
    return [finished(first), Synced(), *(event for job in others for event in (wrong(job), Synced())), Ended({})]


def crashes(group):
    return [finished(group.jobs[0]), Begun(group.jobs[1].key, "first frame"), CRASH]


@pytest.mark.parametrize("script", [draws_nothing, crashes])
def test_from_the_first_that_speaks_against_a_failing_device_all_are_unsupported(play, script):
    testing = finds(FAILING)
    stage = play(ALL, Actor(script), tester=testing)
    rows = stage.rows()
    assert rows.pop(("floor", 4))["status"] == "ok"  # measured before
    assert {(row["status"], row["reason"]) for row in rows.values()} == {("unsupported", REASON)}
    assert len(rows) == len(ALL) - 1
    line, = stage.lines
    assert line == ("fake fails self-tests without which any image may be wrong: blending, queries; what is not "
                    "measured yet is unsupported; see mfr-bench doctor")
    assert stage.tests == 1 and testing.closed
    assert sum(isinstance(request, Group) for request in stage.actors[0].sent) == 1  # nothing more is drawn


@pytest.mark.parametrize(("script", "status"), [(draws_nothing, "wrong"), (crashes, "crashed")])
def test_of_a_device_that_passes_the_method_is_to_blame(play, script, status):
    stage = play(ALL, Actor(script), Actor(well), tester=finds({}))
    rows = stage.rows()
    assert rows["ab-array", 4]["status"] == status
    assert "unsupported" not in {row["status"] for row in rows.values()}
    assert (stage.tests, stage.lines) == (1, [])


def test_a_device_is_not_tested_while_every_image_is_right(play):
    assert play(ALL, Actor(well)).tests == 0


@pytest.mark.parametrize("testing", [Actor(well, Failed("no driver")), Actor(lambda request: [CRASH])])
def test_where_the_self_tests_do_not_end_the_row_stands_and_a_line_says_so(play, testing):
    stage = play(ALL, Actor(draws_nothing), tester=testing)
    assert stage.rows()["ab-array", 4]["status"] == "wrong"
    line, = stage.lines
    assert line == ("a cell is wrong, and whether the device is to blame cannot be told: its self-tests did not end; "
                    "see mfr-bench doctor")


def test_such_cells_are_measured_by_the_next_run_unless_failed_ones_are_kept(play):
    before = play(ALL, Actor(draws_nothing), tester=finds(FAILING))
    row = next(row for row in before.rows().values() if row["status"] == "unsupported")
    assert row["failed_trials"] == ["blending", "queries"]
    key = row["key"]
    assert final(before.sheet.folder, key, keep_failed=True)["status"] == "unsupported"
    assert {row["status"] for row in play(ALL, Actor(well)).rows().values()} == {"ok"}


@pytest.mark.parametrize(("row", "trials"), [
    ({"reason": REASON}, ["blending"]), ({"reason": REASON, "failed_trials": ["blending", "queries"]}, None),
    ({"reason": "needs atomics64, which fails the trial '64-bit atomics' (0 of 9 right)"}, []), ({"reason": None}, [])])
def test_a_record_of_before_names_one_of_the_trials_in_its_reason(row, trials):
    assert failed_trials(row) == (row["failed_trials"] if trials is None else trials)


def test_a_user_who_stops_meanwhile_gets_no_row_of_what_is_not_known(play):
    wish = []
    testing = Actor(lambda request: [lambda: wish.append(1)])
    with pytest.raises(KeyboardInterrupt):
        play(ALL, Actor(draws_nothing), asked=lambda: bool(wish), tester=testing)
    assert [row["status"] for row in play([], Actor(well)).sheet.folder.cells()] == ["ok"]


def test_no_row_is_made_up_where_the_time_is_up_meanwhile(play, monkeypatch):
    now = [0.0]
    monkeypatch.setattr("mfr_bench.run.supervisor.time.monotonic", lambda: now[0])
    testing = Actor(lambda request: [lambda: now.__setitem__(0, 13.0)])
    stage = play(ALL, Actor(draws_nothing), tester=testing, deadline=10.0, last=12.0)
    assert list(stage.rows()) == [("floor", 4)]
    assert stage.lines == []


@pytest.mark.parametrize(("tester", "line"), [
    (finds(FAILING), ("fake fails self-tests without which any image may be wrong: blending, queries; its images "
                      "prove nothing; see mfr-bench doctor")),
    (finds({}), None),
    (Actor(lambda request: [CRASH]), ("the image is wrong, and whether the device is to blame cannot be told: its "
                                      "self-tests did not end; see mfr-bench doctor"))])
def test_outside_runs_a_line_says_whether_the_device_is_to_blame(monkeypatch, tester, line):
    monkeypatch.setattr(processes, "Worker", lambda want, timer: tester)
    assert blame("auto", "the image is wrong") == line
    assert tester.closed


CONFIG = """\
name: distrust
title: Distrust
scene: {size: [32, 24], depth_complexity: 6}
methods: [ab-array, kplus-array]
measure: {target_rel_ci: 0.5, min_samples: 7, max_samples: 7, time_limit_s: 0.5}
"""

# A device that fails an essential trial, and stores no fragment in the arrays of ab-array.
FAULTS = """
from dataclasses import replace
from mfr_bench.glsl import includes
from mfr_bench.gpu import selftest, trials
fails = lambda device: (False, "planted")
selftest.TRIALS = tuple(replace(t, run=fails) if t.name == "queries" else t for t in trials.TRIALS)
real = includes.read
drops = lambda text: text.replace("void main() {", "void main() {\\n    discard;")
includes.read = lambda p: drops(real(p)) if "array/store" in p else real(p)
"""


def test_a_run_tests_its_device_in_a_process_of_its_own(tmp_path):
    path = tmp_path / "distrust.yaml"
    path.write_text(CONFIG)
    ended = apart("run", path, "--out", tmp_path / "out", "--quiet", env=sabotaged(tmp_path / "planted", FAULTS))
    found = {method: row for (method, _), row in cells(tmp_path / "out").items()}
    assert found["ab-array"]["status"] == "unsupported"
    assert found["ab-array"]["reason"].startswith("needs OpenGL as it is specified, which fails the trial 'queries' ")
    assert not {row["status"] for row in found.values()} & {"wrong", "crashed"}
    assert ended.status == 0
    line, = ended.err.splitlines()
    assert " fails self-tests without which any image may be wrong: queries; " in line


def test_a_rendered_image_that_is_wrong_names_the_device_that_fails(tmp_path):
    path = tmp_path / "distrust.yaml"
    path.write_text(CONFIG)
    ended = apart("render", path, "--method", "ab-array", "--out", tmp_path / "image.npy",
                  env=sabotaged(tmp_path / "planted", FAULTS))
    assert ended.status == 3
    line, = ended.err.splitlines()
    assert line.endswith(" fails self-tests without which any image may be wrong: queries; its images prove nothing; "
                         "see mfr-bench doctor")
