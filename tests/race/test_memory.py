"""Weak memory and lockstep: what the shaders rely on holds, and what they do not is seen."""

import pytest

from mfr_bench.methods import catalog
from mfr_bench.race.campaign import run, small_variant
from mfr_bench.race.check import How

SCHEDULES = 1000
MEETING = [m.id for m in catalog().values() if any(p.writes and p.kind == "geometry" for p in m.passes)]


def outcome(method_id: str, how: How, *settings: str):
    return run(small_variant(catalog()[method_id], settings), (3, 2), how, scenes=2)


@pytest.mark.parametrize("method_id", MEETING)
def test_a_method_keeps_its_promise_where_stores_arrive_late(method_id):
    found = outcome(method_id, How(schedules=SCHEDULES, weak=True))
    assert found.failure is None or found.checker.promises_nothing


@pytest.mark.parametrize("method_id", MEETING)
def test_a_method_ends_in_lockstep(method_id):
    found = outcome(method_id, How(schedules=200, warp=4))
    assert found.failure is None or found.checker.promises_nothing


@pytest.mark.parametrize("method_id", ["kplus-array", "kb-ps", "kb-mdt64"])
def test_a_lock_that_a_late_store_releases_is_taken_in_lockstep(method_id):
    settings = ("atomic64=emulated",) if method_id == "kb-mdt64" else ()
    assert outcome(method_id, How(schedules=2000, weak=True, warp=4), *settings).failure is None


@pytest.mark.parametrize("method_id", ["lin-pre", "kb-ll"])
def test_a_load_through_a_link_is_a_race_by_vulkan_s_model(method_id):
    """The headers of these shaders say that they rely on OpenGL's coherent loads."""
    found = outcome(method_id, How(schedules=20_000, weak=True, dependencies=False))
    assert found.failure.what in ("wrong_image", "out_of_bounds_read")


def test_helper_invocations_end_and_leave_no_trace():
    for method_id in ("kplus-array", "lin-pre", "kb-ll"):
        assert outcome(method_id, How(schedules=500, helpers=True)).failure is None


def test_a_schedule_is_the_same_again():
    first, second = (outcome("kb", How(schedules=300, seed=7)).failed for _ in range(2))
    assert first == second > 0
