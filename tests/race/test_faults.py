"""Faults that were found by the machine: mended they are gone, put back they are found again."""

from dataclasses import replace

import pytest

from mfr_bench.methods import catalog
from mfr_bench.race.campaign import run, small_variant
from mfr_bench.race.check import BrokenAloneError, Checker, How
from mfr_bench.race.scenes import row_of

TORN = "return b.y != EMPTY && ordered_alpha(a)"
MOST_OPAQUE = {"criterion": "opaque", "k": 1}
CULLED = {"early_culling": "on"}


def variant(method_id: str, **params):
    return catalog()[method_id].variant(params)


def exhaustive_pair() -> Checker:
    return Checker(variant("kplus-generic", **MOST_OPAQUE), row_of((2,)))


def test_a_torn_slot_refuses_nobody():
    """Two fragments, every schedule with up to two preemptions."""
    outcome = exhaustive_pair().check(How(exhaustive=True, bound=2, schedules=100_000))
    assert outcome.complete and outcome.failure is None


def test_a_torn_slot_is_found(plant):
    """One fragment sees the depth of a slot as it is, and the colour as it was: empty, which has an alpha of 255."""
    plant("methods/kplus/criterion.glsl", TORN, "return b.x != EMPTY && ordered_alpha(a)")
    outcome = exhaustive_pair().check(How(exhaustive=True, bound=2, schedules=100_000))
    assert outcome.failure.what == "wrong_image" and outcome.failure.lost == 0
    assert len(outcome.failure.deviations) <= 3


@pytest.mark.parametrize("atomic64", ["native", "emulated"])
def test_a_displaced_fragment_counts_once(atomic64):
    culled = variant("open-pre", atomic64=atomic64, **CULLED)
    found = run(culled, (3,), How(schedules=6000), scenes=6)
    assert found.failure is None


@pytest.mark.parametrize("atomic64", ["native", "emulated"])
def test_a_displaced_fragment_that_counts_twice_is_found(plant, atomic64):
    plant("methods/open/insert.frag", " && less64(aged(met, 0u), counted)", "")
    found = run(variant("open-pre", atomic64=atomic64, **CULLED), (3,), How(schedules=60_000), scenes=6)
    assert found.failure.what == "wrong_image" and found.seconds < 5


def with_offsets(clear: str):
    """open-pre, emulated, whose probe offsets are made otherwise."""
    method = catalog()["open-pre"]
    buffers = tuple(replace(b, clear=clear) if b.name == "offsets" else b for b in method.buffers)
    return replace(method, buffers=buffers).variant({"atomic64": "emulated"})


def test_no_record_returns_to_its_cell():
    assert run(variant("open-pre", atomic64="emulated"), (4, 2), How(schedules=8000), scenes=4).failure is None


def test_a_record_that_returns_is_found():
    """Ages share offsets: a record comes back to a cell at another age while somebody holds what it was before."""
    found = run(with_offsets("i % 2u + i / 8u"), (4, 2), How(schedules=8000), scenes=2)
    assert found.failure.what == "out_of_bounds_write"


def test_a_plain_load_of_64_bits_is_found(plant):
    """GLSL does not say that it is one access: the walk of the sorted insertion meets a link of one record and a depth
    of another."""
    insert = {"insert": "max64", "culling_opacity": 0.95, **CULLED}
    assert run(variant("lin-pre", **insert), (4,), How(schedules=8000), scenes=8).failure is None
    plant("common/atomic64.glsl", "value = unpackUint2x32(atomicMax(BUFFER64[at], packUint2x32(uvec2(0u))));",
          "value = load64(at);")
    found = run(variant("lin-pre", **insert), (4,), How(schedules=200_000), scenes=20)
    assert found.failure is not None


@pytest.mark.parametrize("method_id", ["kplus-array", "kplus-array-r", "kb-ps"])
def test_locks_end_in_lockstep(method_id):
    assert run(small_variant(catalog()[method_id], ()), (4,), How(schedules=400, warp=4), scenes=2).failure is None


@pytest.mark.parametrize("method_id", ["kplus-array", "kplus-array-r", "kplus-heap", "kb-ps"])
def test_locks_end_where_returns_are_moved(method_id):
    """No return stands before a lock: lanes that fill slots meet those that wait for them, whatever becomes of it."""
    moved = How(schedules=400, warp=4, late=True)
    assert run(small_variant(catalog()[method_id], ()), (4,), moved, scenes=2).failure is None


def test_a_return_before_the_lock_is_found(plant):
    """Moved behind the lock, it keeps lanes waiting for lanes of their own warp."""
    plant("methods/kplus/store_revised.frag", "    bool fills = slot < BOUND;\n",
          "    if (slot >= BOUND) return false;\n    bool fills = true;\n")
    moved = How(schedules=400, warp=4, late=True)
    found = run(small_variant(catalog()["kplus-array-r"], ()), (4,), moved, scenes=2)
    assert found.failure.what in ("stuck", "lost_fragments")


def test_what_fails_without_any_race_is_a_broken_promise_with_its_line(plant):
    plant("methods/array/store.frag", "nodes[slot * pixels + p] =", "nodes[slot * pixels + p + 99u] =")
    with pytest.raises(BrokenAloneError) as error:
        run(variant("ab-array"), (2,), How(schedules=10), scenes=1)
    assert error.value.exit_status == 3
    assert "methods/array/store.frag:11: an access beyond the end of a buffer" in str(error.value)
