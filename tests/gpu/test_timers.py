"""Timers on a GL whose clock is planted: long frames, short frames, a coarse clock."""

from itertools import count

import pytest

from mfr_bench.gpu.timers import MOST_REPEATS, TRIES, GpuTimer, repeats_for, tick, undisturbed_ms


class Gl:
    """Timestamps: those given, then the last for ever."""

    def __init__(self, stamps_ns):
        self._stamps, self._names, self._of, self._now = iter(stamps_ns), count(1), {}, 0

    def generate(self, kind):
        return next(self._names)

    def glQueryCounter(self, query, target):
        self._now = next(self._stamps, self._now)
        self._of[query] = self._now

    def query_result(self, query):
        return self._of[query]


class Device:
    def __init__(self, stamps_ns):
        self.gl = Gl(stamps_ns)

    def finish(self):
        pass


def test_frames_beyond_32_bits_of_nanoseconds_are_right():
    """2**32 ns are 4.29 s; these frames take 10 s and 1 h, and start where a 32-bit clock has wrapped."""
    start = 7 * 2**32 + 5
    assert GpuTimer(Device([start, start + 10**10])).frame_ms(lambda mark: None) == 10_000
    assert GpuTimer(Device([start, start + 36 * 10**11])).frame_ms(lambda mark: None) == 3_600_000


def test_passes_beyond_32_bits_of_nanoseconds_are_right():
    timer = GpuTimer(Device([2**33, 2**33 + 5 * 10**9, 2**33 + 11 * 10**9]))
    assert timer.passes_ms(lambda mark: [mark("store"), mark("resolve")]) == {"store": 5000, "resolve": 6000}


def test_a_sample_of_several_frames_is_their_mean():
    drawn = []
    assert GpuTimer(Device([0, 3_000_000])).frame_ms(drawn.append, repeats=4) == 0.75
    assert len(drawn) == 4


def test_the_resolution_is_the_smallest_step_of_the_clock():
    steps = [1024 * (i // 3) for i in range(1000)]
    assert GpuTimer(Device(steps)).resolution_ms == pytest.approx(0.001024)
    assert GpuTimer(Device([5])).resolution_ms is None
    assert tick([]) is None and tick([3, 3, 1]) is None


@pytest.mark.parametrize(("frame_ms", "resolution_ms", "repeats"), [
    (5.0, 0.001, 1), (0.2, 0.001, 1), (0.1, 0.001, 2), (0.03, 0.001, 7), (0.0, 0.001, MOST_REPEATS),
    (1e-9, 0.001, MOST_REPEATS), (0.1, None, 1)])
def test_a_sample_is_at_least_200_ticks_long(frame_ms, resolution_ms, repeats):
    assert repeats_for(frame_ms, resolution_ms) == repeats


class Clocks:
    """A wall clock and a processor clock, in ms, that a frame moves on by what is planted for it, the last for ever."""

    name = "wall"

    def __init__(self, frames, kind="cpu"):
        self.device = type("Device", (), {"info": {"kind": kind}})
        self.frames, self.drawn, self.processor_ms = frames, 0, 0.0

    def frame_ms(self, draw, repeats=1):
        wall_ms, processor_ms = self.frames[min(self.drawn, len(self.frames) - 1)]
        self.drawn += 1
        self.processor_ms += processor_ms
        return wall_ms / repeats


@pytest.mark.parametrize(("frames", "kind", "time_ms", "drawn"), [
    ([(2.0, 2.0)], "cpu", 2.0, 1),  # nothing held it up
    ([(2.0, 3.5)], "cpu", 2.0, 1),  # two threads at work
    ([(9.0, 2.0), (7.0, 2.1), (2.1, 2.05)], "cpu", 2.1, 3),  # the third is the first that nothing held up
    ([(5.0, 2.0), (4.0, 2.0), (5.0, 2.0)], "cpu", 4.0, TRIES),  # the one that was held up least
    ([(30.0, 2.0), (31.0, 2.0), (2.0, 2.0)], "cpu", 30.0, 2),  # more tries would take too long
    ([(9.0, 0.1), (2.0, 0.1)], "gpu", 9.0, 1),  # the processor waits for a GPU
])
def test_a_frame_that_other_processes_held_up_is_drawn_again(monkeypatch, frames, kind, time_ms, drawn):
    clocks = Clocks(frames, kind)
    monkeypatch.setattr("mfr_bench.gpu.timers.time.process_time", lambda: clocks.processor_ms / 1e3)
    assert undisturbed_ms(clocks, None) == time_ms
    assert clocks.drawn == drawn
