"""`compare` where a reference frame or the other cells tell how much slower the device was for a while."""

import numpy as np
import pytest

from mfr_bench.compare import compare
from mfr_bench.compare.judge import FASTER, SLOWER, UNCLEAR
from mfr_bench.compare.references import References

from .planted import SCENES, cell, side

METHODS = 14
QUIET_MS, SLOW_MS = 0.3, 0.45  # of the reference
PLANTED = "m5, n 32"
TURNS = (0, 0, 0, 0, 1, 1, 1, 2, 2, 2)  # of the frames


def run(seed, times=(), references=None, bursts=0.0):
    """28 cells of 10 frames. times: how many times as long cells take, by name.

    references: of the cells that differ from QUIET_MS, by name; None: no cell has any. bursts: share of the frames that
    take 1.9 times as long.
    """
    random, cells, times = np.random.default_rng(seed), [], dict(times)
    for layers in SCENES:
        for method in range(METHODS):
            name = f"m{method}, n {layers}"
            middle = (1 + method / 7) * layers / 16 * np.exp(0.01 * random.standard_normal()) * times.get(name, 1.0)
            frames = middle * np.exp(0.01 * random.standard_normal(10)) * np.where(random.random(10) < bursts, 1.9, 1)
            known = {} if references is None else {
                "references_ms": [references.get(name, QUIET_MS) + turn / 1000 for turn in TURNS]}
            cells.append(cell(f"m{method}", frames.tolist(), {"depth_complexity": layers}) | known)
    return side(cells)


def called(before, after):
    return {v.name: v.verdict for v in compare(before, after).verdicts if v.verdict in (SLOWER, FASTER)}


def reason(before, after, name=PLANTED):
    (found,) = (v for v in compare(before, after).verdicts if v.name == name)
    assert found.verdict == UNCLEAR
    return found.reason


def test_no_burst_is_allowed_for_where_the_reference_was_as_fast_as_ever():
    """Some frames of other cells take 1.9 times as long, but not all of a cell's while the reference is steady."""
    known, unknown = ([run(1, bursts=0.02, references=r), run(2, {PLANTED: 1.7}, bursts=0.02, references=r)]
                      for r in ({}, None))
    assert called(*known) == {PLANTED: SLOWER}
    assert called(*unknown) == {} and "no other cell of the method moved" in reason(*unknown)


def test_a_reference_that_feels_nothing_of_a_load_makes_no_verdict_bolder():
    """Whole turns of other cells take 1.9 times as long while the reference is as fast as ever."""
    before, after = run(1, references={}), run(2, {PLANTED: 1.7}, {})
    assert called(before, after) == {PLANTED: SLOWER}
    for number, entry in enumerate(before.entries.values()):
        samples = entry.point.cell["samples_ms"]
        if number % 3 == 0:
            entry.point.cell["samples_ms"] = [*samples[:7], *(1.9 * ms for ms in samples[7:])]
    assert called(before, after) == {}


@pytest.mark.parametrize("slow_side", [0, 1])
def test_a_cell_during_which_the_reference_was_slower_is_unclear(slow_side):
    references = [{}, {}]
    references[slow_side] = {PLANTED: SLOW_MS}
    sides = [run(1, references=references[0]), run(2, {PLANTED: 1.7}, references[1])]
    assert called(*sides) == {}
    assert reason(*sides) == "the reference frame was slower while it was sampled: measure both again"


@pytest.mark.parametrize(("times", "reference", "slower"), [(2.56, 1.3, True), (2.56, 2.1, False), (1.6, 1.3, False)])
def test_what_is_far_beyond_what_slowed_the_reference_down_is_a_change(times, reference, slower):
    """Frames are slowed down by no more than a quarter further than the reference, which moves as much data as any."""
    before, after = run(1, references={}), run(2, {PLANTED: times}, {PLANTED: reference * QUIET_MS})
    assert called(before, after) == ({PLANTED: SLOWER} if slower else {})


def test_ten_times_the_time_is_more_than_a_slower_device_makes():
    assert called(run(1, references={}), run(2, {PLANTED: 10.0}, {PLANTED: SLOW_MS})) == {PLANTED: SLOWER}


def test_cells_during_which_the_reference_was_slower_do_not_hide_others():
    """A third of the cells takes 1.6 times as long, as their references tell: 1.3 times in another is still found."""
    slowed = [f"m{method}, n {layers}" for method in (0, 6, 7, 8) for layers in SCENES]
    sides = [run(1, references={}), run(2, dict.fromkeys(slowed, 1.6) | {PLANTED: 1.3}, dict.fromkeys(slowed, SLOW_MS))]
    assert called(*sides) == {PLANTED: SLOWER}


def test_a_run_that_was_slower_as_a_whole_tells_nothing_of_its_cells():
    names = [f"m{method}, n {layers}" for method in range(METHODS) for layers in SCENES]
    slower = run(2, references=dict.fromkeys(names, SLOW_MS))
    before = run(1, references={})
    assert set(References([(b, slower.entries[key]) for key, b in before.entries.items()]).steady) == {None}
    assert called(before, slower) == {}


def test_half_of_the_cells_in_another_mode_do_not_hide_five_times_the_time():
    """The burst is that of two threads that share one of two cores for a while: 1.5 times as long, and never more."""
    slowed = {f"m{method}, n {layers}": 1.5 for method in range(0, METHODS, 2) for layers in SCENES}
    before, after = run(1, slowed), run(2, {PLANTED: 5.0})
    assert called(before, after) == {PLANTED: SLOWER}
    assert called(before, run(2)) == {}


def test_a_cell_that_moved_by_a_burst_is_not_supported_by_one_that_changed_far_more():
    before = run(1, bursts=0.02)
    assert called(before, run(2, {PLANTED: 10.0, "m5, n 16": 1.8}, bursts=0.02)) == {PLANTED: SLOWER}
    assert called(before, run(2, {PLANTED: 1.8, "m5, n 16": 1.8}, bursts=0.02)) == {PLANTED: SLOWER, "m5, n 16": SLOWER}


@pytest.mark.parametrize("hit", [["m5, n 32"], ["m5, n 16", "m5, n 32"], ["m3, n 16", "m5, n 32", "m9, n 16"]],
                         ids=["a cell", "a method", "three methods"])
def test_bursts_that_the_reference_felt_raise_no_alarm_and_hide_nothing(hit):
    """1.8 times as long in all frames of the cells that are hit, while one cell of another method is twice as slow."""
    for seed in range(0, 20, 2):
        before = run(seed, references={}, bursts=0.02)
        slowed, felt = dict.fromkeys(hit, 1.8), dict.fromkeys(hit, SLOW_MS)
        assert called(before, run(seed + 1, slowed, felt, bursts=0.02)) == {}
        assert called(before, run(seed + 1, slowed | {"m0, n 16": 2.0}, felt, bursts=0.02)) == {"m0, n 16": SLOWER}
