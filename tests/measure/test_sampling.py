"""When sampling goes on and why it stops; how often the interval it stops with holds the truth."""

import numpy as np
import pytest

from mfr_bench.config.model import Measure
from mfr_bench.measure.sampling import WARMUP_FRAMES, Sampler, halves_agree


def fed(sampler, times):
    """Give the sampler what it asks for, one after another."""
    times = iter(times)
    while sampler.wanted:
        for _ in range(sampler.wanted):
            sampler.add(next(times))
            if not sampler.wanted:
                break
    return sampler


def steady(value=1.0):
    while True:
        yield value


def noise(seed, deviation):
    """Frames of 1 ms, log-normal, as frame times are: skewed to the slow side, the median 1 ms."""
    random = np.random.default_rng(seed)
    while True:
        yield float(np.exp(random.normal(0, deviation)))


def test_steady_frames_stop_as_soon_as_there_are_enough():
    sampler = fed(Sampler(Measure()), steady())
    assert (len(sampler.warmup_ms), len(sampler.samples_ms)) == (WARMUP_FRAMES[0], 10)
    assert sampler.stop_reason == "precise"
    assert not sampler.noisy
    assert sampler.interval == (1, 1, 1)


def test_warm_up_goes_on_until_its_halves_agree():
    sampler = fed(Sampler(Measure()), [9, 5, 3, *[1.0] * 23])
    assert len(sampler.warmup_ms) == 16  # at 2, 4 and 8 frames the later half was still faster
    assert set(sampler.samples_ms) == {1.0}


def test_warm_up_ends_though_the_halves_never_agree():
    falling = (1.0 / frame for frame in range(1, 10**6))
    assert len(fed(Sampler(Measure(target_rel_ci=0.5)), falling).warmup_ms) == WARMUP_FRAMES[-1]


def test_warm_up_takes_no_more_than_its_share_of_the_time():
    sampler = fed(Sampler(Measure(time_limit_s=1.0)), (1000.0 / frame for frame in range(1, 10**6)))
    assert len(sampler.warmup_ms) == 1  # the first frame alone took a second
    assert sampler.stop_reason == "time limit"


@pytest.mark.parametrize(("times", "agree"), [([1, 1], True), ([1.04, 1], True), ([1.1, 1], False), ([1, 1.1], False),
                                              ([1, 9, 1, 1, 9, 1], True), ([2, 2, 2, 1, 1, 1], False)])
def test_halves_agree_within_5_percent_of_their_medians(times, agree):
    assert halves_agree(times) == agree


def test_batches_grow():
    sampler = Sampler(Measure(target_rel_ci=1e-6, max_samples=60))
    asked = []
    for time in noise(1, 0.1):
        if sampler.warm:
            asked.append(len(sampler.samples_ms) + sampler.wanted)
        sampler.add(time)
        if not sampler.wanted:
            break
    assert list(dict.fromkeys(asked)) == [10, 15, 22, 33, 49, 60]
    assert sampler.stop_reason == "most samples"
    assert sampler.noisy


def test_time_runs_out():
    sampler = fed(Sampler(Measure(target_rel_ci=1e-6, time_limit_s=0.1)), noise(2, 0.1))
    assert sampler.stop_reason == "time limit"
    assert 0.1 <= sampler.spent_s < 0.11
    assert sampler.noisy


def test_time_that_runs_out_with_a_narrow_interval_was_enough():
    sampler = fed(Sampler(Measure(target_rel_ci=0.05, min_samples=50, time_limit_s=0.02)), steady())
    assert sampler.stop_reason == "precise"
    assert len(sampler.samples_ms) == 18


def test_too_few_samples_for_an_interval_are_never_precise():
    sampler = fed(Sampler(Measure(min_samples=3, max_samples=5)), steady())
    assert sampler.stop_reason == "most samples"
    assert sampler.rel_half_width is None
    assert sampler.noisy


def test_fewer_samples_at_most_than_at_least():
    assert len(fed(Sampler(Measure(min_samples=10, max_samples=8)), steady()).samples_ms) == 8


def test_the_share_done_grows_to_one():
    sampler = Sampler(Measure(target_rel_ci=1e-6, max_samples=100))
    shares = [sampler.share]
    for time in noise(3, 0.1):
        sampler.add(time)
        shares.append(sampler.share)
        if not sampler.wanted:
            break
    assert shares[0] == 0
    assert shares == sorted(shares)
    assert shares[-1] == 1


@pytest.mark.parametrize(("frames", "enough"), [(5, False), (2 + 9, False), (2 + 10, True)])
def test_interrupted_samples_are_kept_where_there_are_enough(frames, enough):
    sampler = Sampler(Measure(target_rel_ci=1e-6))
    for _ in range(frames):
        sampler.add(1.0 + 0.01 * (len(sampler.samples_ms) % 3))
    assert sampler.interrupt() == enough
    assert sampler.stop_reason == "interrupted"
    assert sampler.wanted == 0


def test_an_interruption_does_not_hide_why_it_had_stopped():
    sampler = fed(Sampler(Measure()), steady())
    assert sampler.interrupt()
    assert sampler.stop_reason == "precise"


@pytest.mark.parametrize(("measure", "at_least"), [
    (Measure(target_rel_ci=1e-9, min_samples=10, max_samples=10), 0.95),
    (Measure(target_rel_ci=1e-9, min_samples=33, max_samples=33), 0.95),
    (Measure(target_rel_ci=0.05, min_samples=10, max_samples=1000), 0.90),  # stopping when narrow costs some coverage
])
def test_the_interval_holds_the_true_median(measure, at_least):
    """Over 400 fixed seeds; three standard deviations of that many trials are 3 %."""
    intervals = [fed(Sampler(measure), noise(seed, 0.1)).interval for seed in range(400)]
    held = sum(low <= 1 <= high for low, _, high in intervals) / len(intervals)
    assert held >= at_least - 0.03
