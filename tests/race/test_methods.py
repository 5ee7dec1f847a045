"""Every method of the catalog keeps its promise under every schedule that is tried."""

import pytest

from mfr_bench.methods import catalog
from mfr_bench.race.campaign import run, small_variant
from mfr_bench.race.check import How

SCHEDULES = 2000
SLOW = 200  # where a frame has hundreds of invocations


def schedules_for(variant) -> int:
    return SLOW if variant.params.get("scan") == "compute" else SCHEDULES


def show(found) -> str:
    from mfr_bench.race.report import text

    return text(found)


@pytest.mark.parametrize("method", catalog().values(), ids=lambda m: m.id)
def test_a_method_keeps_its_promise(method):
    variant = small_variant(method, ())
    found = run(variant, (3, 2), How(schedules=schedules_for(variant)), scenes=2)
    assert not found.broken or found.checker.promises_nothing, show(found)


@pytest.mark.parametrize(("fragments", "settings", "passes"), [
    ((4,), (), ["order", "blend"]), ((4,), ("flat=stored",), ["store", "resolve"]),
    ((3, 2), (), ["store", "resolve"]), ((5, 4), (), ["clear", "store", "resolve"]),
    ((3, 2), ("shallow=memory",), ["clear", "store", "resolve"]),
    ((3, 2), ("spare_memory=0",), ["count", "clear", "allocate", "store", "resolve"])])
def test_each_plan_of_the_adaptive_method_keeps_its_promise(fragments, settings, passes):
    found = run(small_variant(catalog()["adaptive"], settings), fragments, How(schedules=SLOW), scenes=2)
    assert list(dict.fromkeys(p.step.name for p in found.checker.frame.passes)) == list(dict.fromkeys(passes))
    assert not found.broken, show(found)


@pytest.mark.parametrize("method", [m for m in catalog().values() if m.loses_ties], ids=lambda m: m.id)
def test_who_loses_equal_depths_shows_one_of_each(method):
    found = run(small_variant(method, ("k=3",) if method.param("k") else ()), (4, 3, 2), How(schedules=500), scenes=2,
                ties=True)
    assert not found.broken, show(found)


@pytest.mark.parametrize("method_id", ["kb", "kb-mha"])
def test_hazards_show(method_id):
    """A machine on which nothing ever goes wrong would prove nothing."""
    found = run(small_variant(catalog()[method_id], ()), (4,), How(schedules=500), scenes=1)
    assert found.checker.promises_nothing and found.failed > 50


def test_without_a_lock_fragments_are_lost():
    found = run(small_variant(catalog()["kplus-array"], ["sync=none"]), (4,), How(schedules=500), scenes=1)
    assert found.checker.promises_nothing and found.failed > 50


def test_a_dedicated_atomic_counter_is_a_word_of_memory():
    found = run(small_variant(catalog()["lin-post"], ["allocation=dedicated"]), (3, 2), How(schedules=1000), scenes=2)
    assert found.failure is None


WIDE = {"open-post": 1, "open-pre": 1}  # preemptions where a frame clears hundreds of cells
GROUPED = ("ab-precalc", "ab-coherent")  # in groups of 64 invocations and more, whose orders have no end
UNGROUPED = {"adaptive": ("flat=stored",)}  # of one that has a way without such groups


@pytest.mark.parametrize("method_id", [m.id for m in catalog().values() if m.id not in GROUPED and any(
    p.writes and p.kind == "geometry" for p in m.passes)])
def test_two_fragments_keep_the_promise_in_every_order(method_id):
    """Every schedule with up to two preemptions."""
    how = How(exhaustive=True, bound=WIDE.get(method_id, 2), schedules=30_000)
    found = run(small_variant(catalog()[method_id], UNGROUPED.get(method_id, ())), (2,), how, scenes=1)
    assert found.complete or found.checker.promises_nothing
    assert not found.broken or found.checker.promises_nothing, show(found)


FETCHED = ((5, 4), (4, 5, 3, 1), (2, 0, 3, 3))  # fragments of pixels, by a guess that no more than eight meet or surely


@pytest.mark.parametrize("fragments", FETCHED, ids=str)
@pytest.mark.parametrize("how", [How(), How(weak=True), How(warp=4), How(in_flight=2), How(helpers=True)],
                         ids=["strong", "weak", "lockstep", "two in flight", "helpers"])
def test_fragments_kept_in_the_framebuffer_come_in_order_of_submission(fragments, how):
    """Those of a pixel one by one, of other pixels meanwhile: all are kept, sorted, on every machine."""
    found = run(small_variant(catalog()["adaptive"], ()), fragments, how, scenes=2)
    fetching = [p.step.name for p in found.checker.frame.passes if p.step.fetched]
    assert fetching == ["store", "resolve"] and all(p.concurrent for p in found.checker.frame.passes if p.step.fetched)
    assert found.schedules >= how.schedules and not found.broken, show(found)


def test_equal_depths_in_the_framebuffer_stay_in_order_of_submission():
    """Among equal depths the first submitted is the nearest, in every schedule; here nothing else is allowed."""
    found = run(small_variant(catalog()["adaptive"], ()), (5, 4), How(), scenes=2, ties=True)
    assert not found.broken and len(found.checker.images) == 1, show(found)
