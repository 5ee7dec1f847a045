"""Turns of samples are watched by a reference frame, and taken again where the device was slower meanwhile."""

from __future__ import annotations

import pytest

from mfr_bench.config.model import Measure
from mfr_bench.measure.sampling import Sampler
from mfr_bench.measure.watch import EVERY_S, PAUSE_S, SELDOM_S, SHARE, Unwatched, Watch


class Machine:
    """A clock, and a device whose reference frame takes what the schedule says from a time on."""

    def __init__(self, *schedule):
        self.now_s, self.schedule = 0.0, schedule

    def reference_ms(self, best_ms):
        return next(ms for since_s, ms in reversed(self.schedule) if self.now_s >= since_s)

    def sleep(self, seconds):
        self.now_s += seconds

    def watch(self):
        return Watch(self.reference_ms, lambda: self.now_s, self.sleep)


def took(machine, watch, seconds):
    with watch.turn() as turn:
        machine.now_s += seconds
    return turn


def again(watch, turn, wait_s):
    return watch.slower(turn) and watch.again(turn.took_s, wait_s)


def test_a_steady_device_is_not_slower():
    machine = Machine((0, 0.3), (2, 0.34))
    watch = machine.watch()
    assert [watch.slower(took(machine, watch, 1.0)) for _ in range(4)] == [False] * 4


def test_a_burst_that_began_or_ended_within_the_turn_is_seen():
    machine = Machine((0, 0.3), (1.5, 0.5), (2.5, 0.3))
    watch = machine.watch()
    turns = [took(machine, watch, 1.0) for _ in range(4)]
    assert [watch.slower(turn) for turn in turns] == [False, True, True, False]
    assert [turn.reference_ms for turn in turns] == [0.3, 0.5, 0.5, 0.3]


def test_the_look_behind_a_turn_is_that_before_the_next_one_but_not_for_long():
    machine, looks = Machine((0, 0.3)), []
    watch = Watch(lambda best_ms: looks.append(machine.now_s) or 0.3, lambda: machine.now_s, machine.sleep)
    took(machine, watch, 1.0)
    machine.now_s += EVERY_S / 2
    took(machine, watch, 1.0)
    machine.now_s += 2 * EVERY_S
    took(machine, watch, 1.0)
    assert looks == pytest.approx([0.0, 1.0, 2.0 + EVERY_S / 2, 2.0 + 2.5 * EVERY_S, 3.0 + 2.5 * EVERY_S])


def test_short_turns_share_the_looks_before_and_behind_them():
    """The device is slower when the fourth turn ends, by when the look before the first tells nothing more."""
    short_s = EVERY_S / 3.5
    machine = Machine((0, 0.3), (3.5 * short_s, 0.5))
    watch = machine.watch()
    turns = [took(machine, watch, short_s) for _ in range(8)]
    assert [turn.reference_ms for turn in turns] == [0.5] * 8 and all(map(watch.slower, turns))
    machine.schedule = ((0, 0.3),)
    turns = [took(machine, watch, short_s) for _ in range(2)]
    watch.look_behind()
    assert [turn.reference_ms for turn in turns] == [0.5, 0.5]
    last = took(machine, watch, short_s)
    assert last.reference_ms == 0.3 and not watch.slower(last)


def test_nothing_is_looked_at_behind_turns_that_have_been():
    machine, looks = Machine((0, 0.3)), []
    watch = Watch(lambda best_ms: looks.append(machine.now_s) or 0.3, lambda: machine.now_s, machine.sleep)
    watch.look_behind()
    took(machine, watch, EVERY_S / 2)
    watch.look_behind()
    watch.look_behind()
    assert looks == [0.0, EVERY_S / 2]


def test_a_turn_is_taken_again_while_a_tenth_of_the_time_pays_for_it():
    machine = Machine((0, 0.3), (19.5, 0.5))
    watch = machine.watch()
    for _ in range(19):
        assert not again(watch, took(machine, watch, 1.0), 0.0)
    assert again(watch, took(machine, watch, 1.0), 0.0)  # 20 s of turns pay for 2 s
    assert again(watch, took(machine, watch, 1.0), 0.0)
    assert not again(watch, took(machine, watch, 1.0), 0.0)
    assert again(watch, took(machine, watch, 1.0), 5.0)


def test_waiting_ends_with_the_burst():
    machine, looks = Machine((0, 0.3), (1.0, 0.5), (4.0, 0.3)), []
    watch = machine.watch()
    assert again(watch, took(machine, watch, 2.0), 60.0)
    watch.wait(60.0, lambda: looks.append(machine.now_s))
    assert 4.0 <= machine.now_s <= 4.0 + 2 * PAUSE_S and len(looks) == pytest.approx(2.0 / PAUSE_S, abs=2)


def test_waiting_ends_with_what_may_be_spent_and_later_turns_count():
    machine = Machine((0, 0.3), (1.0, 0.5))
    watch = machine.watch()
    turn = took(machine, watch, 2.0)
    assert again(watch, turn, 5.0)
    watch.wait(5.0, lambda: None)
    assert machine.now_s == pytest.approx(2.0 + 5.0 + SHARE * 2.0 - 2.0)  # less the turn that is taken again
    assert not again(watch, took(machine, watch, 2.0), 5.0)


def test_ctrl_c_ends_the_waiting():
    machine = Machine((0, 0.3), (1.0, 0.5))
    watch = machine.watch()
    took(machine, watch, 2.0)

    def interrupted():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        watch.wait(60.0, interrupted)


def test_nothing_is_watched_unless_it_is_asked_for():
    with Unwatched().turn() as turn:
        pass
    assert not Unwatched().again(turn.took_s, 60.0) and turn.reference_ms is None and not Unwatched().slower(turn)


def test_samples_set_aside_are_taken_again():
    sampler = Sampler(Measure(min_samples=3, max_samples=3, target_rel_ci=0.5, time_limit_s=10.0))
    sampler.warm = True
    for time_ms in (1.0, 1.0, 1.8):
        sampler.add(time_ms)
    assert not sampler.wanted
    sampler.set_aside([2])
    assert (sampler.samples_ms, sampler.aside_ms, sampler.wanted) == ([1.0, 1.0], [1.8], 1)
    assert sampler.spent_s == pytest.approx(0.002)
    sampler.add(1.0)
    assert sampler.samples_ms == [1.0] * 3 and not sampler.wanted


def test_a_long_frame_set_aside_does_not_use_up_the_time_limit():
    sampler = Sampler(Measure(min_samples=3, max_samples=3, time_limit_s=0.2))
    sampler.warm, sampler.warmup_ms = True, [300.0]
    sampler.add(310.0)
    assert sampler.stop_reason == "time limit"
    sampler.set_aside([0])
    assert sampler.wanted and not sampler.samples_ms


def test_while_no_samples_are_taken_it_looks_seldom():
    looks, machine = [], Machine((0, 0.3))
    watch = Watch(lambda best_ms: looks.append(machine.now_s) or 0.3, lambda: machine.now_s)
    for _ in range(50):
        watch.look_seldom()
        machine.now_s += 0.4 * SELDOM_S
    assert looks == pytest.approx([1.2 * SELDOM_S * number for number in range(17)])
