"""Cells whose turns a reference frame watches: what it says of the device changes while the run goes on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.gpu.frame import Frame
from mfr_bench.measure.watch import Watch
from mfr_bench.run.cell import CellWork
from mfr_bench.run.events import WAIT, Begun

from .planted_cells import MEASURE, Clock, Run, cell

QUIET_MS, SLOW_MS = 0.3, 0.5  # of the reference
WAITING = replace(MEASURE, wait_s=60.0)


class Host:
    """A machine that is slower until the timer has drawn so many frames, and within any frames that are given."""

    def __init__(self, made, until, slower=()):
        self.timer, self.until, self.slower, self.now_s, self.looks = made.measuring.bench.timer, until, slower, 0.0, 0
        self.timer.frame_ms = self.frame_ms
        made.measuring.bench.watch = Watch(self.reference_ms, lambda: self.now_s, self.sleep)

    @property
    def slow(self):
        return self.timer.frames < self.until or self.timer.frames in self.slower

    def frame_ms(self, draw, repeats=1):
        time_ms = 1.8 if self.slow else 1.0
        self.timer.frames += 1
        self.now_s += time_ms / 1e3
        draw(None)
        return time_ms

    def reference_ms(self, best_ms):
        self.looks += 1
        return SLOW_MS if self.slow else QUIET_MS

    def sleep(self, seconds):
        self.now_s += seconds
        self.slower = ()


def measured(device, tmp_path, measure, *host):
    made = Run(device, [cell("floor", measure=measure)], Clock(), tmp_path)
    host = Host(made, *host)
    made.all()
    (row,) = made.rows
    return row, host, [event for event in made.events if event == Begun(row["key"], WAIT)]


def test_samples_that_a_later_turn_shows_to_have_been_slower_are_taken_again(device, tmp_path):
    """The device is slower until the second turn ends: nothing faster is known when the first one is taken."""
    row, _, waits = measured(device, tmp_path, WAITING, 9)
    assert row["samples_ms"] == [1.0] * 7 and set(row["references_ms"]) == {QUIET_MS}
    assert row["aside_ms"] == [1.8] * 6 and waits


def test_a_wrong_image_of_samples_taken_again_is_found_where_the_run_is_interrupted(device, tmp_path, monkeypatch):
    """The image of the last sample was checked, and right, before samples were taken back."""
    taken_back, image, take_again = [], Frame.image, CellWork.take_again

    def taking_again(work):
        again = take_again(work)
        if again:
            taken_back.append((work.sampler, len(work.sampler.samples_ms)))
        return again

    monkeypatch.setattr(CellWork, "take_again", taking_again)
    monkeypatch.setattr(Frame, "image", lambda self: image(self) + np.float32(bool(taken_back)))
    made = Run(device, [cell(measure=replace(WAITING, max_samples=30))], Clock(), tmp_path,
               interrupted=lambda: any(len(sampler.samples_ms) > left for sampler, left in taken_back))
    Host(made, 9)
    with pytest.raises(KeyboardInterrupt):
        made.all()
    row, = made.rows
    assert taken_back == [(taken_back[0][0], 24)] and row["values"]["samples"] == 25
    assert (row["status"], row["values"]["stop_reason"]) == ("wrong", "interrupted")


def test_they_are_kept_where_no_time_is_given_for_it(device, tmp_path):
    row, _, waits = measured(device, tmp_path, MEASURE, 9)
    assert row["samples_ms"] == [1.8] * 6 + [1.0] and row["aside_ms"] == [] and not waits
    assert row["references_ms"] == [SLOW_MS] * 6 + [QUIET_MS]


def test_the_best_of_the_reference_is_known_before_the_first_turn(device, tmp_path):
    """The device is slower from the first turn on, and not while the cell is prepared."""
    row, host, waits = measured(device, tmp_path, WAITING, 0, range(1, 100))
    assert waits and row["samples_ms"] == [1.0] * 7 and row["aside_ms"]
    assert host.now_s < 1.0


@pytest.mark.parametrize("eliminate", [False, True])
def test_nothing_is_looked_at_where_rounds_are_not_watched(device, tmp_path, eliminate):
    made = Run(device, [cell(measure=replace(MEASURE, eliminate=eliminate))], Clock(), tmp_path)
    host = Host(made, 0)
    made.all()
    assert bool(host.looks) != eliminate
