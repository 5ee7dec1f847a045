"""The loop over groups, with workers that act out what goes wrong; no process, no device, no time."""

from __future__ import annotations

import pytest

from mfr_bench import plan
from mfr_bench.config.model import Measure
from mfr_bench.errors import DeviceError
from mfr_bench.run import device_process as processes
from mfr_bench.run.events import (
    CHECK,
    WAIT,
    Begun,
    Calibrated,
    Ended,
    Failed,
    Finished,
    Go,
    Group,
    Ready,
    Sampled,
    Stop,
)
from mfr_bench.run.supervisor import GRACE_S, Supervisor

from .acting import CELLS, CRASH, Actor, cell, finished, well
from .fake_worker import DEVICE

MIB = 2**20


def test_every_cell_is_a_row_and_each_sync_is_answered(play):
    stage = play(CELLS, Actor(well))
    assert {row["status"] for row in stage.rows().values()} == {"ok"}
    assert [row["values"]["sessions"] for row in stage.rows().values()] == [1, 1, 1]
    sent = stage.actors[0].sent
    assert sum(isinstance(request, Go) for request in sent) == 6
    assert stage.actors[0].closed


def test_a_crash_costs_the_cell_in_hand_and_the_others_go_on_from_their_samples(play):
    def crashes(group):
        first, second, _ = group.jobs
        return [Begun(first.key, "sampling"), Sampled(first.key, (1.0, 2.0)), Begun(second.key, "sampling"), CRASH]

    stage = play(CELLS, Actor(crashes), Actor(well))
    rows = stage.rows()
    assert (rows["ab-array", 4]["status"], rows["ab-array", 4]["reason"]) == ("crashed", "sampling: killed by SIGSEGV")
    assert rows["floor", 4]["status"] == rows["kplus-array", 4]["status"] == "ok"
    assert (rows["floor", 4]["values"]["sessions"], rows["kplus-array", 4]["values"]["sessions"]) == (2, 1)
    again, = [request for request in stage.actors[1].sent if isinstance(request, Group)]
    assert {job.cell.method for job in again.jobs} == {"floor", "kplus-array"}
    assert [partial.samples_ms for partial in again.partials.values()] == [[1.0, 2.0]]


def test_a_crash_while_the_scene_is_made_costs_its_cells_and_no_other_scene(play):
    def crashes(group):
        return [Begun(None, "scene"), CRASH] if group.jobs[0].cell.scene.depth_complexity == 4 else well(group)

    rows = play([*CELLS, cell("floor", n=9)], Actor(crashes), Actor(crashes)).rows()
    assert {row["reason"] for (_, n), row in rows.items() if n == 4} == {"scene: killed by SIGSEGV"}
    assert rows["floor", 9]["status"] == "ok"


def test_a_row_that_was_told_before_the_death_stands(play):
    def leaves(group):
        first, *_ = group.jobs
        return [Begun(first.key, "compile"), Finished(first.key, "crashed", "GL_CONTEXT_LOST", {}), ("crashed", "lost")]

    rows = play(CELLS, Actor(leaves), Actor(well)).rows()
    assert rows["floor", 4]["reason"] == "GL_CONTEXT_LOST"
    assert rows["ab-array", 4]["status"] == "ok"


def test_a_cell_that_takes_too_long_is_ended(play, monkeypatch):
    now = [0.0]
    monkeypatch.setattr(processes.time, "monotonic", lambda: now[0])
    measure = Measure(time_limit_s=2, hard_limit_s=30)

    def later():
        now[0] += 4  # less than what counts as a parent that was stopped

    def hangs(group):
        return [Begun(group.jobs[0].key, "first frame"), *[later] * 20]

    stage = play([cell("floor", measure=measure), cell("ab-array", measure=measure)], Actor(hangs), Actor(well))
    rows = stage.rows()
    assert (rows["floor", 4]["status"], rows["floor", 4]["reason"]) == (
        "timeout", "first frame: no end within 30 s (measure.hard_limit_s)")
    assert rows["ab-array", 4]["status"] == "ok"


def test_what_a_killed_worker_had_still_said_changes_no_blame(play, monkeypatch):
    """The cell that was too long ends in the same moment, and the next begins: that one is not to blame."""
    now = [0.0]
    monkeypatch.setattr(processes.time, "monotonic", lambda: now[0])

    def later():
        now[0] += 4

    def late(group):
        first, second = group.jobs
        return [Begun(first.key, "sampling"), *[later] * 9, finished(first), Begun(second.key, "compile")]

    measure = Measure(time_limit_s=2, hard_limit_s=30)
    rows = play([cell(m, measure=measure) for m in ("floor", "ab-array")], Actor(late), Actor(well)).rows()
    assert {row["status"] for row in rows.values()} == {"ok"}


def test_time_in_which_the_parent_was_stopped_does_not_count(play, monkeypatch):
    now = [0.0]
    monkeypatch.setattr(processes.time, "monotonic", lambda: now[0])

    def stopped():
        now[0] += 3600

    def patient(group):
        first, *_ = well(group)
        return [first, stopped, *well(group)]

    assert {row["status"] for row in play(CELLS, Actor(patient)).rows().values()} == {"ok"}


@pytest.mark.parametrize("apart", [CHECK, WAIT])
def test_time_in_which_the_harness_compares_images_or_waits_is_no_time_of_the_method(play, monkeypatch, apart):
    """FLIP of a large image, or a busy machine, takes longer than the cell may; samples before and after it stand."""
    now = [0.0]
    monkeypatch.setattr(processes.time, "monotonic", lambda: now[0])
    measure = Measure(time_limit_s=2, hard_limit_s=30)

    def later():
        now[0] += 4

    def compares(group):
        (job,) = group.jobs
        return [Begun(job.key, "first frame"), later, Begun(job.key, apart), *[later] * 50, Begun(job.key, "sampling"),
                *[later] * 5, Sampled(job.key, (1.0,)), Begun(job.key, apart), *[later] * 50, finished(job), Ended({})]

    assert play([cell("floor", measure=measure)], Actor(compares)).rows()["floor", 4]["status"] == "ok"


def test_the_default_limit_leaves_room_for_ten_time_limits():
    assert Measure(time_limit_s=10).longest_s == 220
    assert Measure(time_limit_s=10, hard_limit_s=15).longest_s == 15


def test_a_worker_that_takes_too_much_memory_is_ended(play):
    measure = Measure(hard_limit_mb=100)
    greedy = Actor(lambda group: [Begun(group.jobs[0].key, "sampling"), grows])

    def grows():
        greedy.held = 101 * MIB

    rows = play([cell("floor", measure=measure), cell("ab-array", measure=measure)], greedy, Actor(well)).rows()
    assert (rows["floor", 4]["status"], rows["floor", 4]["reason"]) == (
        "out_of_memory", "sampling: the process that measures took 101 MiB, allowed: 100 MiB (measure.hard_limit_mb)")
    assert rows["ab-array", 4]["status"] == "ok"


def test_deaths_that_no_cell_is_to_blame_for_are_tried_again_but_not_for_ever(play):
    assert {r["status"] for r in play(CELLS, Actor(lambda group: [CRASH]), Actor(well)).rows().values()} == {"ok"}
    with pytest.raises(DeviceError, match="again and again"):
        play([cell("floor", n=9)], *[Actor(lambda group: [CRASH]) for _ in range(9)])


OTHER = Ready({**DEVICE, "renderer": "other"}, None, "wall", {})


@pytest.mark.parametrize("opening", [Failed("no driver"), CRASH, OTHER])
def test_a_device_that_does_not_come_back_ends_the_run(play, opening):
    def crashes(group):
        return [Begun(group.jobs[0].key, "compile"), CRASH]

    with pytest.raises(DeviceError, match=r"^the OpenGL device fake is gone: "):
        play(CELLS, Actor(crashes), *[Actor(well, opening) for _ in range(processes.STARTS)])


def test_a_device_that_comes_back_late_is_used(play):
    def crashes(group):
        return [Begun(group.jobs[0].key, "compile"), CRASH]

    rows = play(CELLS, Actor(crashes), Actor(well, Failed("not yet")), Actor(well)).rows()
    assert sorted(row["status"] for row in rows.values()) == ["crashed", "ok", "ok"]


@pytest.mark.parametrize(("opening", "said"), [(Failed("no driver; install one"), "^no driver; install one$"),
                                              (CRASH, "cannot be opened: killed by SIGSEGV")])
def test_without_a_device_there_is_one_line(play, opening, said):
    with pytest.raises(DeviceError, match=said):
        play(CELLS, Actor(well, opening))


def test_a_wish_to_stop_reaches_the_worker_once(play):
    wish = []
    actor = Actor(lambda group: [Begun(group.jobs[0].key, "sampling"), lambda: wish.append(1), None, None,
                                 Ended({}, interrupted=True)])
    with pytest.raises(KeyboardInterrupt):
        play(CELLS, actor, asked=lambda: bool(wish))
    assert sum(isinstance(request, Stop) for request in actor.sent) == 1


def test_a_worker_that_does_not_stop_for_the_user_is_given_up(play, monkeypatch):
    """It may compile for half a minute. The clock is planted; no cell is blamed, and what had come is kept."""
    now, wish, folder = [0.0], [], []
    monkeypatch.setattr(processes.time, "monotonic", lambda: now[0])

    def script(group):
        first, second, *_ = group.jobs
        folder[:] = [first.key, second.key]
        return [Begun(first.key, "sampling"), finished(first), Begun(second.key, "compile"), lambda: wish.append(1),
                lambda: now.__setitem__(0, 0.9 * GRACE_S), lambda: now.__setitem__(0, 1.1 * GRACE_S)]

    actor = Actor(script)
    with pytest.raises(KeyboardInterrupt):
        play(CELLS, actor, asked=lambda: bool(wish))
    assert actor.killed and sum(isinstance(request, Stop) for request in actor.sent) == 1
    kept = play(CELLS, Actor(well)).actors[0].sent
    measured, = ([job.key for job in request.jobs] for request in kept if isinstance(request, Group))
    assert folder[0] not in measured and folder[1] in measured


def test_at_the_deadline_what_is_in_hand_stops_and_the_rest_is_left(play, monkeypatch):
    """The clock is planted: the time is up while the first scene is measured. No row is made up for what is left."""
    now = [0.0]
    monkeypatch.setattr(processes.time, "monotonic", lambda: now[0])

    def script(group):
        first, *_ = group.jobs
        return [Begun(first.key, "sampling"), finished(first), lambda: now.__setitem__(0, 11.0), None, None,
                Ended({}, interrupted=True)]

    actor = Actor(script)
    stage = play([*CELLS, cell("ab-array", n=9)], actor, deadline=10.0)
    assert list(stage.rows()) == [("floor", 4)]
    assert sum(isinstance(request, Stop) for request in actor.sent) == 1
    assert sum(isinstance(request, Group) for request in actor.sent) == 1


def test_at_the_last_moment_a_worker_that_does_not_stop_is_ended_without_a_row(play, monkeypatch):
    """The clock is planted: the worker is at one cell when the time is up, and still when the answer is due."""
    now = [0.0]
    monkeypatch.setattr(processes.time, "monotonic", lambda: now[0])

    def script(group):
        first, second, *_ = group.jobs
        return [Begun(first.key, "sampling"), finished(first), Begun(second.key, "compile"),
                lambda: now.__setitem__(0, 11.0), None, lambda: now.__setitem__(0, 12.5), None, None]

    actor = Actor(script)
    stage = play(CELLS, actor, deadline=10.0, last=12.0)
    assert list(stage.rows()) == [("floor", 4)]
    assert actor.killed and sum(isinstance(request, Group) for request in actor.sent) == 1


# --- what is hopeless ----------------------------------------------------------------------------


def slow(group):
    """Frames of 3 s a fragment per pixel."""
    return [*[finished(job, 3000.0 * job.cell.scene.depth_complexity) for job in group.jobs], Ended({})]


def test_what_took_too_long_is_not_tried_on_more_work(play):
    cells = [cell(m, n=n, k=2) for n in (9, 1, 4, 5) for m in ("floor", "kplus-array")]
    stage = play(cells, Actor(slow))
    rows = stage.rows()
    assert {n for (_, n), row in rows.items() if row["status"] == "timeout"} == {5, 9}
    assert rows["floor", 5]["reason"].startswith("floor at 8 x 8 pixels, n = 4 took 12 s a frame, where time_limit_s "
                                                 "allows 10 s for all frames; --try-hopeless")
    assert rows["kplus-array", 9]["reason"].startswith("kplus-array at 8 x 8 pixels, n = 4, k = 2 took 12 s")
    groups = [request for request in stage.actors[0].sent if isinstance(request, Group)]
    assert [group.jobs[0].cell.scene.depth_complexity for group in groups] == [1, 4]  # small ones first


def test_hopeless_cells_are_tried_where_that_is_asked_for(play):
    rows = play([cell("floor", n=n) for n in (4, 9)], Actor(slow), try_hopeless=True).rows()
    assert {row["status"] for row in rows.values()} == {"ok"}


def test_what_is_hopeless_is_known_from_before(play):
    play([cell("floor", n=4)], Actor(slow))
    stage = play([cell("floor", n=4), cell("floor", n=9)], Actor(slow))
    assert stage.rows()["floor", 9]["status"] == "timeout"
    assert not any(isinstance(request, Group) for request in stage.actors[0].sent)


def stalls(group):
    """Frames of 1 ms, but for the one sample of a small cell, which was stalled for 50 s."""
    def row(job):
        if job.cell.scene.depth_complexity != 4:
            return finished(job)
        return Finished(job.key, "ok", None, {"time_ms": 5e4, "timer": "wall"},
                        {"samples_ms": [5e4], "warmup_ms": [1.0, 1.0]})

    return [*map(row, group.jobs), Ended({})]


def test_one_stalled_sample_condemns_no_larger_cell(play):
    rows = play([cell("floor", n=n) for n in (4, 9, 16)], Actor(stalls)).rows()
    assert {row["status"] for row in rows.values()} == {"ok"}


def test_condemned_cells_are_measured_once_their_evidence_has_gone(play):
    """Rows of a run that took the stall for the truth."""
    cells = [cell("floor", n=n) for n in (4, 9)]
    stage = play(cells, Actor(slow))
    rows = stage.rows()
    stage.sheet.folder.write_cell(rows["floor", 4] | {"warmup_ms": [1.0]})
    stage.sheet.folder.write_cell(rows["floor", 9] | {"status": "timeout", "reason": f"long; {plan.NOT_TRIED}",
                                                      "values": {}})
    assert play(cells, Actor(well)).rows()["floor", 9]["status"] == "ok"


def test_after_a_timeout_larger_k_of_the_same_scene_are_left_out(play):
    def hangs(group):
        return [Begun(group.jobs[0].key, "first frame"), ("timeout", "no end within 220 s")]

    stage = play([cell("kplus-heap", k=k) for k in (2, 1, 8)], Actor(hangs), Actor(well))
    rows = {row["params"]["k"]: row for row in stage.sheet.folder.cells()}
    assert {k: row["status"] for k, row in rows.items()} == {1: "ok", 2: "timeout", 8: "timeout"}
    assert "n = 4, k = 2 timed out" in rows[8]["reason"]


@pytest.mark.parametrize(("events", "found"), [
    ([Calibrated({"timer": "gpu"})], {"timer": "gpu"}), ([Ended({}), Calibrated({"timer": "wall"})], {"timer": "wall"}),
    ([CRASH], None)])
def test_the_calibration_at_the_end_is_the_workers_or_none(monkeypatch, events, found):
    worker = Actor(lambda group: [])
    monkeypatch.setattr(processes, "Worker", lambda want, timer=None: worker)
    with Supervisor("auto") as supervisor:
        supervisor.ready()
        worker.events += events
        assert supervisor.calibrate_again() == found


def test_a_user_who_stops_the_run_waits_for_no_calibration(monkeypatch):
    worker = Actor(lambda group: [])
    monkeypatch.setattr(processes, "Worker", lambda want, timer=None: worker)
    with Supervisor("auto", asked=lambda: True) as supervisor:
        supervisor.ready()
        assert supervisor.calibrate_again() is None
