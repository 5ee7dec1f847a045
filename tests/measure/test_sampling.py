"""The end of sampling and its reason; the share of intervals at that end that contain the truth."""

import numpy as np
import pytest

from mfr_bench.config.model import Measure
from mfr_bench.measure import sampling
from mfr_bench.measure.sampling import TURNS, WARMUP_FRAMES, Sampler, halves_agree
from mfr_bench.stats import interleaved_ratio, turns


def fed(sampler, times):
    """Give the sampler what it asks for, turn by turn."""
    times = iter(times)
    while sampler.wanted:
        for _ in sampler.turn():
            sampler.add(next(times))
    return sampler


def steady(value=1.0):
    while True:
        yield value


def noise(seed, deviation):
    """Frames of 1 ms, log-normal, as frame times are: skewed to the slow side, the median 1 ms."""
    return noise_of("lognormal", deviation, seed).tolist()


def test_steady_frames_stop_as_soon_as_there_are_enough():
    sampler = fed(Sampler(Measure()), steady())
    assert (len(sampler.warmup_ms), len(sampler.samples_ms)) == (WARMUP_FRAMES[0] + TURNS - 1, 10)
    assert sampler.stop_reason == "precise"
    assert not sampler.noisy
    assert sampler.interval == (1, 1, 1)


def test_warm_up_goes_on_until_its_halves_agree():
    sampler = fed(Sampler(Measure()), [9, 5, 3, *[1.0] * 25])
    assert len(sampler.warmup_ms) == 8 + TURNS - 1  # at 2 and 4 frames the later half was still faster
    assert set(sampler.samples_ms) == {1.0}


def test_warm_up_ends_though_the_halves_never_agree():
    falling = (1.0 / frame for frame in range(1, 10**6))
    assert len(fed(Sampler(Measure(target_rel_ci=0.5)), falling).warmup_ms) == WARMUP_FRAMES[-1] + TURNS - 1


def test_warm_up_takes_no_more_than_its_share_of_the_time():
    sampler = fed(Sampler(Measure(time_limit_s=1.0)), (1000.0 / frame for frame in range(1, 10**6)))
    assert len(sampler.warmup_ms) == 1  # the first frame alone took a second
    assert sampler.stop_reason == "time limit"


def test_a_single_sample_follows_one_frame_of_warm_up():
    """Whoever asks for one sample asks for images: frames that still get faster are not waited for."""
    sampler = fed(Sampler(Measure(max_samples=1, min_samples=1)), [9.0, 5.0, 3.0, *[1.0] * 40])
    assert (sampler.warmup_ms, sampler.samples_ms, sampler.stop_reason) == ([9.0], [5.0], "most samples")


@pytest.mark.parametrize(("frames_ms", "warm_up"), [
    ([202.0, 4.0, 354.0], 2),  # two stalls, as on a machine with other work
    ([300.0, 280.0, 290.0, 295.0], 3),  # a method that is slower than the limit
])
def test_a_lone_sample_over_the_time_limit_has_more_frames_beside_it(frames_ms, warm_up):
    """The fastest frame shows whether a cell is slow: larger ones are not tried then. Two stalls must not show that."""
    sampler = fed(Sampler(Measure(max_samples=1, min_samples=1, time_limit_s=0.2)), frames_ms)
    assert (sampler.warmup_ms, sampler.samples_ms) == (frames_ms[:warm_up], frames_ms[warm_up:])


def test_one_stalled_frame_does_not_stand_for_a_cell():
    """Frames of 0.2 ms, the first sample stalled beyond the time limit: two more outvote it."""
    sampler = fed(Sampler(Measure(time_limit_s=0.05)), [0.2, 0.2, 50.6, *[0.2] * 9])
    assert sampler.samples_ms == [50.6, 0.2, 0.2] and sampler.interval[1] == 0.2
    slow = fed(Sampler(Measure(time_limit_s=0.05)), steady(60.0))
    assert slow.samples_ms == [60.0] and slow.stop_reason == "time limit"


@pytest.mark.parametrize(("times", "agree"), [([1, 1], True), ([1.04, 1], True), ([1.1, 1], False), ([1, 1.1], True),
                                              ([1, 9, 9, 1, 9, 1], True), ([2, 2, 2, 1, 2, 2], False)])
def test_halves_agree_unless_the_later_has_a_frame_5_percent_faster(times, agree):
    assert halves_agree(times) == agree


def test_batches_grow_and_take_three_turns_each():
    sampler = Sampler(Measure(target_rel_ci=1e-6, max_samples=60))
    times, ends = iter(noise(1, 0.1)), []
    while sampler.wanted:
        for _ in sampler.turn():
            sampler.add(next(times))
        ends.append(len(sampler.samples_ms))
    assert ends == [4, 8, 10, 12, 14, 15, 18, 21, 22, 26, 30, 33, 39, 45, 49, 53, 57, 60]
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


@pytest.mark.parametrize(("frame_ms", "settling"), [(1.0, 1), (20.0, 0)])
def test_a_turn_is_a_third_of_a_batch_the_first_with_the_warm_up_before_it(frame_ms, settling):
    """From the second turn on a short frame comes first that does not count."""
    sampler, turns = Sampler(Measure(target_rel_ci=1e-6)), []
    times = iter([9 * frame_ms, 5 * frame_ms, 3 * frame_ms, *(frame_ms * noise_of("lognormal", 0.1, 1)).tolist()])
    while len(turns) < 9:
        turns.append(sum(1 for _ in sampler.turn() if sampler.add(next(times)) is None))
    warm = len(sampler.warmup_ms) - 8 * settling
    assert turns == [warm + 4, *(settling + share for share in (4, 2, 2, 2, 1, 3, 3, 1))]


def test_a_burst_of_load_that_a_turn_falls_into_does_not_move_the_median():
    """So does not what is slow right after other methods drew."""
    sampler, number = Sampler(Measure(min_samples=7, max_samples=7)), 0
    while sampler.wanted:
        for at, _ in enumerate(sampler.turn()):
            sampler.add(1.6 if number == 1 or (number and not at) else 1.0)
        number += 1
    assert number == 3 and sorted(sampler.samples_ms) == [1.0] * 4 + [1.6] * 3


def shares(sampler):
    """Samples of each turn from now on, of frames of other than one length."""
    found, times = [], iter((LONG * noise_of("lognormal", 0.1, 1)).tolist())
    while sampler.wanted:
        before = len(sampler.samples_ms)
        for _ in sampler.turn():
            sampler.add(next(times))
        found.append(len(sampler.samples_ms) - before)
    return found


@pytest.mark.parametrize(("earlier", "then"), [(0, [4, 4, 2, 2, 2, 1]), (8, [2, 2, 2, 1]), (10, [2, 2, 1]),
                                               (12, [2, 1])])
def test_batches_that_go_on_from_earlier_samples_have_the_shares_that_they_had(earlier, then):
    sampler = Sampler(Measure(target_rel_ci=1e-6, max_samples=15))
    sampler.resume((LONG * noise_of("lognormal", 0.1, 2))[:earlier].tolist())
    assert shares(sampler) == then


@pytest.mark.parametrize(("back", "then"), [
    ([], [2, 2, 1]),
    ([10, 11], [2, 2, 1]),  # the turn before
    (range(8), [4, 4, 3]),  # most of the first batch, found out later
    (range(12), [5, 5, 5]),
])
def test_a_batch_of_which_earlier_samples_are_taken_back_begins_anew_in_three_turns(back, then):
    sampler = Sampler(Measure(target_rel_ci=1e-6, max_samples=15))
    sampler.resume((LONG * noise_of("lognormal", 0.1, 2))[:12 if back else 10].tolist())
    sampler.warm, sampler.warmup_ms = True, [LONG]
    sampler.set_aside(back)
    assert shares(sampler) == then


BETWEEN_CV, WITHIN_CV = 0.092, 0.04  # of turns, and of frames of one turn: 84 and 16 % of the variance
SPREAD_SAMPLES = 33


def sampled_of_turns(seed):
    """A cell on a host whose speed differs from turn to turn, and its number of turns; each has as many samples."""
    random, turns = np.random.default_rng(seed), 0
    sampler = Sampler(Measure(target_rel_ci=1e-6, max_samples=SPREAD_SAMPLES, time_limit_s=1000))
    while sampler.wanted:
        speed, turns = LONG * np.exp(BETWEEN_CV * random.standard_normal()), turns + 1
        for _ in sampler.turn():
            sampler.add(float(speed * np.exp(WITHIN_CV * random.standard_normal())))
    return sampler, turns


def spread_of_medians():
    """The standard deviation of the logarithms of the medians of many such cells."""
    return np.std([np.log(sampled_of_turns(seed)[0].interval[1]) for seed in range(TRIALS)])


def test_short_turns_take_a_quarter_off_the_error_of_as_many_samples_where_turns_differ(monkeypatch):
    sampler, turns = sampled_of_turns(1)
    assert (len(sampler.samples_ms), turns) == (SPREAD_SAMPLES, 12)
    short = spread_of_medians()
    monkeypatch.setattr(sampling, "TURNS", 1)
    sampler, turns = sampled_of_turns(1)
    assert (len(sampler.samples_ms), turns) == (SPREAD_SAMPLES, 4)
    assert short <= 0.75 * spread_of_medians()


# --- planted noise: how often the interval holds the truth ---------------------------------------

TRIALS = 400
FRAMES = 1100  # most samples, and the longest warm-up
LONG = 16.0  # ms, of a frame so long that every one counts; a power of two: times so many, a number keeps all its bits


def trend_of(kind, cv, random):
    """Logarithm of the time that frames would take without noise, in the course of a sampling.

    drift: one deviation of the noise over the longest sampling. waves: half of one up and down, with a period of 50
    frames. wander: a random walk, a deviation in a thousand frames.
    """
    frames = np.arange(FRAMES)
    return {"drift": lambda: cv * frames / 1000,
            "steep drift": lambda: 0.1 * frames / 1000,
            "waves": lambda: 0.5 * cv * np.sin(2 * np.pi * (frames / 50 + random.random())),
            "wander": lambda: cv * np.cumsum(random.standard_normal(FRAMES)) / np.sqrt(1000),
            }.get(kind, lambda: np.zeros(FRAMES))()


def noise_of(kind, cv, seed):
    """Frames of 1 ms whose noise is `cv` of it."""
    random = np.random.default_rng([seed, int(cv * 1000)])
    trend = trend_of(kind, cv, random)
    if kind == "exponential":  # skewed as far as a distribution of times can be
        return 1 - cv + random.exponential(cv, FRAMES)
    if kind == "t3":  # no fourth moment
        return np.exp(cv * random.standard_t(3, FRAMES) / np.sqrt(3))
    if kind == "normal":
        return 1 + cv * random.standard_normal(FRAMES)
    times = np.exp(trend + cv * random.standard_normal(FRAMES))
    hit = random.random(FRAMES) < (0.1 if kind == "contaminated" else 0)  # by something else that the machine does
    return np.where(hit, times * (1 + 10 * cv * random.random(FRAMES)), times)


def median_of_the_period(kind, cv, seed, sampler):
    """The median of all frames that the sampled period could have had: of the mixture of their distributions."""
    special = pytest.importorskip("scipy.special")
    if kind == "exponential":
        return 1 - cv + cv * np.log(2)
    first = len(sampler.warmup_ms)
    trend = trend_of(kind, cv, np.random.default_rng([seed, int(cv * 1000)]))[first:first + len(sampler.samples_ms)]

    def below(log_time):
        if kind != "contaminated":
            return special.ndtr((log_time - trend) / cv).mean()
        slower = np.log1p(10 * cv * (np.arange(200) + 0.5) / 200)  # the factor is uniform
        return 0.9 * special.ndtr(log_time / cv) + 0.1 * special.ndtr((log_time - slower) / cv).mean()

    low, high = trend.min() - cv, trend.max() + cv
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if below(middle) < 0.5 else (low, middle)
    return np.exp(low)


def coverage(kind, cv, **measure):
    held = 0
    for seed in range(TRIALS):
        sampler = fed(Sampler(Measure(time_limit_s=1000, **measure)), (LONG * noise_of(kind, cv, seed)).tolist())
        low, _, high = (end / LONG for end in sampler.interval)
        held += low <= median_of_the_period(kind, cv, seed, sampler) <= high
    return held / TRIALS


KINDS = ("normal", "lognormal", "exponential", "t3", "contaminated", "drift", "waves", "wander")


@pytest.mark.parametrize("cv", [0.005, 0.02, 0.05, 0.1])
@pytest.mark.parametrize("kind", KINDS)
def test_the_interval_holds_the_true_median(kind, cv):
    """In 92 to 98 % of fixed trials that stop where the interval is narrow enough, or at 1000 samples."""
    assert 0.92 <= coverage(kind, cv) <= 0.98


@pytest.mark.parametrize("cv", [0.005, 0.02, 0.05])
def test_a_drift_that_outdoes_the_noise_makes_the_interval_no_narrower(cv):
    """10 % in a thousand frames: the interval of all that was sampled holds the median of it at least as often."""
    assert coverage("steep drift", cv) >= 0.93


def leaning(seed, correlation=0.4, cv=0.05):
    """Frames that lean on the one before: log-normal, autoregressive."""
    random, value, times = np.random.default_rng(seed), 0.0, []
    for step in random.standard_normal(FRAMES):
        value = correlation * value + (1 - correlation**2) ** 0.5 * step
        times.append(LONG * float(np.exp(cv * value)))
    return times


def test_frames_that_lean_on_their_neighbours_are_not_taken_for_independent():
    """82 % of the intervals would hold the median if they were."""
    samplers = [fed(Sampler(Measure(time_limit_s=1000)), leaning(seed)) for seed in range(TRIALS)]
    assert sum(s.interval[0] <= LONG <= s.interval[2] for s in samplers) / TRIALS >= 0.88


# --- ratios --------------------------------------------------------------------------------------


def in_turns(kind, cv, seed, ratio=1.5):
    """Samples of two methods that take turns under one trend, each until it has enough."""
    random = np.random.default_rng([seed, int(cv * 1000), 7])
    trend = trend_of(kind, cv, random)
    pair = []
    for factor in (ratio, 1.0):
        times = LONG * factor * np.exp(trend + cv * random.standard_normal(FRAMES))
        pair.append(fed(Sampler(Measure(time_limit_s=1000)), times.tolist()).samples_ms)
    return pair


@pytest.mark.parametrize("cv", [0.005, 0.02, 0.05, 0.1])
@pytest.mark.parametrize("kind", ["lognormal", "drift", "waves", "wander", "steep drift"])
def test_the_interval_of_a_ratio_holds_it_whatever_drifts(kind, cv):
    intervals = [interleaved_ratio(*in_turns(kind, cv, seed), 10, 1000) for seed in range(200)]
    assert sum(low <= 1.5 <= high for low, _, high in intervals) / len(intervals) >= 0.92


def in_uneven_turns(count, between, common, seed, ratio=1.5, cv=0.15):
    """`count` samples each of two methods that take turns.

    between: the share of the variance that lies between turns. common: the share of this that both have in common.
    """
    random = np.random.default_rng([seed, count, int(100 * between), int(100 * common)])
    sizes = [len(range(count)[place]) for place in turns(count, 10, 1000)]
    both, pair = random.standard_normal(len(sizes)), []
    for factor in (ratio, 1.0):
        own = common**0.5 * both + (1 - common) ** 0.5 * random.standard_normal(len(sizes))
        logs = np.repeat(between**0.5 * own, sizes) + (1 - between) ** 0.5 * random.standard_normal(count)
        pair.append((LONG * factor * np.exp(cv * logs)).tolist())
    return pair


def ratio_coverage(count, between, common, trials=1000):
    """The share of intervals that hold the ratio, and their median half-width on a logarithmic scale."""
    intervals = [interleaved_ratio(*in_uneven_turns(count, between, common, seed), 10, 1000) for seed in range(trials)]
    widths = [np.log(high / low) / 2 for low, _, high in intervals]
    return sum(low <= 1.5 <= high for low, _, high in intervals) / trials, float(np.median(widths))


@pytest.mark.parametrize("count", [10, 13, 15, 22, 49])
@pytest.mark.parametrize(("between", "common"), [(0.0, 0.0), (0.5, 0.0), (0.84, 0.0), (0.84, 0.15)])
def test_the_interval_of_a_ratio_takes_a_turn_as_the_unit(count, between, common):
    """Frames of one turn are alike: with batches as the unit and frames as independent, 77 to 90 % held the ratio."""
    held, _ = ratio_coverage(count, between, common)
    assert 0.92 <= held <= 0.98


@pytest.mark.parametrize(("count", "most"), [(15, 0.08), (22, 0.06), (110, 0.03)])
def test_what_turns_of_both_have_in_common_leaves_the_interval_of_their_ratio(count, most):
    """The interval is that of six turns and more; with batches as the unit it was about twice as wide."""
    held, width = ratio_coverage(count, 0.84, 1.0)
    assert 0.92 <= held <= 0.98 and width < most
    apart = ratio_coverage(count, 0.84, 0.0)[1]
    assert width < apart / 2
