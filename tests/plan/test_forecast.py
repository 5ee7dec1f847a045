"""Predicted times: of planted measurements, by the sampling rules, by calibration."""

import math
import random
from dataclasses import replace

import pytest

from mfr_bench.config.model import Measure, Scene
from mfr_bench.plan import Cell, expected_stats
from mfr_bench.plan.forecast import (
    ALIKE,
    CALIBRATED,
    MEASURED,
    OTHER_WORK,
    UNSTEADY,
    ByFragments,
    Forecast,
    FrameTime,
    Rates,
    Record,
    calibrated,
    frames_s,
    other_frames,
    rates_of,
    rough_duration,
)

from ..report import planted

SCENE = Scene(size=(64, 64), depth_complexity=32)
MEASURE = Measure(target_rel_ci=0.05, min_samples=10, max_samples=100, time_limit_s=1.0)
FREE = Rates(start_s=0, compile_s=0, pixel_s=0, store_s=0, report_s=0)


def cell(method="a", scene=SCENE, measure=MEASURE, **params):
    return Cell("planted", method, method, params, scene, measure, {})


def record(method="a", time_ms=5.0, scene=SCENE, **parts):
    fragments = expected_stats(scene).F
    return planted.cell(method, time_ms=time_ms, scene=scene.as_dict(), values={"fragments": fragments}, **parts)


@pytest.mark.parametrize(("time_ms", "cv", "seconds"), [
    # 1.4 until it is prepared, 17 to warm up and settle, 10 samples, 7 of passes, 1 whose fragments are counted
    (1.0, 0.01, 0.0014 + 0.027 + 0.007 + 0.001),
    (1.0, 0.1, 0.0014 + 0.0411 + 0.007 + 0.001),  # (1.96 * 1.2533 * 0.1 / 0.05)**2 samples
    (50.0, 0.3, 0.07 + 1.025 + 0.15 + 0.05),  # the time limit ends samples and passes
    (3000.0, 0.01, 4.2 + 7.5 + 3.1 + 3.0),  # no fewer than two frames
])
def test_the_sampling_rules_bound_a_cells_frames(time_ms, cv, seconds):
    assert frames_s(FrameTime(time_ms, cv, MEASURED), MEASURE) == pytest.approx(seconds, rel=0.02)


@pytest.mark.parametrize(("asked", "frames"), [
    ({}, 1), ({"keep": ("image",)}, 2), ({"keep": ("loss", "error")}, 2), ({"keep": ("fragments",)}, 1),
    ({"repeat_images": 5}, 6)])
def test_images_that_are_kept_or_compared_take_frames_of_their_own(asked, frames):
    assert other_frames(replace(MEASURE, **asked)) == frames


def test_cells_of_which_nothing_is_known_are_sometimes_sampled_as_long_as_they_may_be():
    measure = replace(MEASURE, max_samples=200)
    sure, unsure = (frames_s(FrameTime(1.0, 0.01, source), measure) for source in (MEASURED, ALIKE))
    most = frames_s(FrameTime(1.0, 1.0, MEASURED), measure)
    assert unsure == pytest.approx(sure + UNSTEADY * (most - sure))
    assert most > 4 * sure


def test_a_measured_cell_foretells_itself_whatever_its_shaders_were():
    forecast = Forecast([record(time_ms=5.0, glsl_hash="old")], FREE)
    frame = forecast.frame(cell(), expected_stats(SCENE))
    assert (frame.time_ms, frame.source) == (pytest.approx(5.0), MEASURED)
    assert 0 < frame.cv < 0.02


def test_another_scene_takes_what_its_work_is_of_that_of_the_nearest_fragments():
    """Twice the fragments take less than twice as long; many more fragments nearly in proportion to their number."""
    small, large = replace(SCENE, depth_complexity=8), replace(SCENE, depth_complexity=64)
    works = [expected_stats(scene).F + OTHER_WORK for scene in (small, SCENE, large)]
    before, grown = works[0] / works[1], works[2] / works[1]
    forecast = Forecast([record(time_ms=5.0 * before, scene=small), record(time_ms=5.0)], replace(FREE, round_ns=0))
    frame = forecast.frame(cell(scene=large), expected_stats(large))
    assert 1.5 < grown < 2
    assert (frame.time_ms, frame.source) == (pytest.approx(5.0 * grown, rel=1e-3), ALIKE)


def test_a_part_of_a_frame_does_not_grow():
    """Half of 1 ms is what passes take to begin and end: eight times the fragments take less than 5 ms."""
    large = replace(SCENE, depth_complexity=256)
    forecast = Forecast([record(time_ms=1.0)], replace(FREE, round_ns=0.5))
    frame = forecast.frame(cell(scene=large), expected_stats(large))
    assert 3.5 < frame.time_ms < 5


def test_scenes_that_were_measured_show_how_frames_grow():
    """Twenty methods take four times as long for twice the work; the next one is foretold to do so, too."""
    large = replace(SCENE, depth_complexity=64)
    seen = [record(f"m{i}", time_ms, scene) for i in range(20) for time_ms, scene in ((10.0, SCENE), (40.0, large))]
    straight, steep = (Forecast([*more, record(time_ms=10.0)], replace(FREE, round_ns=0)).frame(
        cell(scene=large), expected_stats(large)).time_ms for more in ((), seen))
    assert straight < 20 < 1.3 * straight < steep < 40


def test_of_a_method_s_cells_that_with_the_same_parameters_foretells_another_scene():
    large = replace(SCENE, depth_complexity=64)
    few, many = (planted.cell("a", params={"k": k}, time_ms=ms, scene=SCENE.as_dict(),
                              values={"fragments": expected_stats(SCENE).F}) for k, ms in ((4, 5.0), (64, 20.0)))
    forecast = Forecast([few, many], replace(FREE, round_ns=0))
    times_ms = [forecast.frame(cell(scene=large, k=k), expected_stats(large)).time_ms for k in (4, 64)]
    assert times_ms[1] == pytest.approx(4 * times_ms[0])


def test_a_method_that_was_never_measured_is_calibrated():
    rates = calibrated({"timer": "wall", "wall_ms": [1.0, 2.0, 4.0], "gpu_ms": [9.0, 9.0, 9.0]})
    assert rates.round_ns == pytest.approx(4e6 / 64 / 512**2)
    slow = replace(rates, round_ns=10 * rates.round_ns)
    frames = [Forecast([record("b")], r).frame(cell(), expected_stats(SCENE)) for r in (rates, slow)]
    assert frames[0].source == CALIBRATED
    assert frames[1].time_ms == pytest.approx(10 * frames[0].time_ms)
    assert calibrated({}) == Rates()


def test_a_run_is_what_its_cells_and_what_surrounds_them_take():
    rates = Rates(start_s=1, compile_s=0.5, pixel_s=1e-4, store_s=0.1, report_s=0.2)
    found = Forecast([record(time_ms=5.0)], rates).run([cell(), cell("b")])
    assert found.sources == {MEASURED: 1, CALIBRATED: 1}
    assert found.total_s - found.frames_s == pytest.approx(1 + 2 * (0.5 + 0.4096 + 0.1 + 0.2))
    assert "1 measured here, 1 by calibration alone" in found.text
    assert Forecast([], rates).run([]).total_s == 0


def test_a_run_takes_no_longer_than_its_time_budget():
    found = Forecast([record(time_ms=5.0)], Rates(pixel_s=1e-2)).run([cell()])
    assert found.total_s > 40 and found.within(None) == found.within(1e6) == found
    assert found.within(10).text.startswith("about 10 s (") and found.within(10).checks_s < 10


def test_what_it_takes_to_check_large_images_is_predicted():
    found = Forecast([record(time_ms=5.0)], Rates(pixel_s=1e-2)).run([cell()])
    assert found.checks_s == pytest.approx(1e-2 * 64 * 64) and found.checks_s > found.total_s / 2
    assert "(40 s of it to check images)" in found.text
    assert "check" not in Forecast([record(time_ms=5.0)], Rates(pixel_s=1e-9)).run([cell()]).text


def test_rates_are_those_of_earlier_runs_each_counted_once():
    """A run of two configs tells its time in both manifests."""
    split = {"start-up": 2.0, "compile": 4.0, "check": 1.0, "store": 0.4, "report": 0.8, "measure": 99.0}
    first = {"split_s": split, "started": "2026-01-01T00:00:00Z"}
    rows = [record(), record("b"), planted.cell("c", time_ms=None, status="unsupported", reason="needs x")]
    rates = rates_of([(first, rows[:1]), (first, rows[1:])], {})
    assert (rates.start_s, rates.compile_s, rates.store_s, rates.report_s) == (2.0, 2.0, 0.2, 0.4)
    assert rates.pixel_s == pytest.approx(1 / (2 * 64 * 64))
    assert rates_of([({}, rows), ({"split_s": {"report": 1.0}}, rows)], {}) == Rates()


@pytest.mark.parametrize(("seconds", "text"), [(0.2, "1 s"), (7.4, "7 s"), (44, "40 s"), (170, "3 min"),
                                               (9000, "2.5 h")])
def test_a_forecast_has_no_more_digits_than_it_is_worth(seconds, text):
    assert rough_duration(seconds) == text


def test_the_nearest_record_is_found_among_many():
    """The same one as by a look at each, the first of those that are equally near."""
    rng = random.Random(3)  # noqa: S311 - numbers of fragments, not secrets
    numbers = [rng.choice((0, rng.randrange(1, 40), rng.randrange(1, 10**7))) for _ in range(300)]
    records = [Record(number, FrameTime(float(place), 0.1, ALIKE)) for place, number in enumerate(numbers)]
    known = ByFragments()
    for record_of in records:
        known.add(record_of)
    for wanted in [0, 1, 5, 10**8, *(rng.randrange(1, 10**7) for _ in range(100)), *numbers[:50]]:
        ratio = [abs(math.log((each.fragments + OTHER_WORK) / (wanted + OTHER_WORK))) for each in records]
        assert known.nearest(wanted) is records[ratio.index(min(ratio))]
