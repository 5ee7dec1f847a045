"""The work of a frame's passes, counted by programs of their own in a frame that is not timed."""

from __future__ import annotations

from collections import Counter
from functools import partial

import numpy as np

from ..glsl import stages
from ..glsl.counters import MOST
from ..methods.spec import LISTED, TILE_COMMAND, Loop, Pass
from .frame import Frame
from .pass_runner import PassRunner

RASTERIZED = Pass("rasterized", "geometry", "probe/rasterized.frag", region=True)

Work = Counter[str]


def work_of(frame: Frame) -> dict[str, dict[str, int]]:
    """Work of each pass of a frame, by its name, summed over its draws; draws a frame.

    Beside the counters of `glsl.counters.WORK` stand `rasterized`, the fragments of a pass's geometry; `passed`, the
    fragments or pixels that reach its targets; and `cleared`, texels that clears set. `words_read` and `words_written`
    take in the targets: what is written to them, blended with and tested against.
    """
    rasterized = _rasterized(frame)
    runners = {id(step): CountingRunner(frame, step, rasterized) for step in frame.running}
    try:
        frame.draw_by(runners)
        return _by_name(runners)
    finally:
        for runner in runners.values():
            runner.release()


def _by_name(runners: dict[int, CountingRunner]) -> dict[str, dict[str, int]]:
    found: dict[str, Work] = {}
    for runner in runners.values():
        total = found.setdefault(runner.step.name, Counter())
        for name, value in runner.work.items():
            total[name] = max(total[name], value) if name in MOST else total[name] + value
    return {name: dict(work) for name, work in found.items()}


def _rasterized(frame: Frame) -> int:
    """Fragments of the geometry before any test."""
    runner = PassRunner(frame, RASTERIZED)
    try:
        return frame.gl.samples_passed(lambda: runner.run(0))
    finally:
        runner.release()


def admitted_map(frame: Frame) -> np.ndarray | None:
    """uint32 (H, W): fragments that asked for the lock, or were stored without it.

    Draws a frame. The others were discarded before: by early z, or by the test that needs no lock. None for a method
    without a lock, and for one that meets a fragment more than once.
    """
    if any(isinstance(step, Loop) for step in frame.variant.steps):
        return None
    runners = {id(step): MapRunner(frame, step) for step in frame.variant.passes
               if frame.fitted.needed(step) and not step.probes}
    try:
        return frame.draw_map(runners) if any(runner.maps for runner in runners.values()) else None
    finally:
        for runner in runners.values():
            runner.release()


class MapRunner(PassRunner):
    """A pass whose program counts for each pixel the fragments that enter; `maps`: whether it has any to count."""

    maps = False

    def _stages(self):
        found = stages(self.frame.fitted, self.step, mapped="entered")
        self.maps = any(stage.counted for stage in found)
        return found


class CountingRunner(PassRunner):
    """A pass whose programs count; what they counted is added to `work` after each run."""

    def __init__(self, frame: Frame, step: Pass, rasterized: int):
        super().__init__(frame, step)
        self.rasterized = rasterized
        self.work: Work = Counter()

    def _stages(self):
        return stages(self.frame.fitted, self.step, counted=True)

    def run(self, iteration: int) -> None:
        self.frame.reset_work()
        drawn = self.step.kind in ("geometry", "fullscreen")
        if drawn and not self.step.counts:
            self._add_targets(self.gl.samples_passed(partial(super().run, iteration)))
        else:
            super().run(iteration)
        self._add_clears()
        counted = self.frame.work()
        for name in MOST:
            counted[name] = max(counted[name], self.work[name]) - self.work[name]
        self.work.update(counted)

    def _add_targets(self, passed: int) -> None:
        geometry = self.step.kind == "geometry"
        rasterized = _rasterized(self.frame) if geometry and self._band else self.rasterized
        texels = {ref: self.frame.allocation.texture(ref, 0) for ref in self.step.into}
        words = {ref: texture.bytes // (4 * self.frame.stats.P) for ref, texture in texels.items()}
        colour = sum(count for ref, count in words.items() if not texels[ref].is_depth)
        depth = sum(count for ref, count in words.items() if texels[ref].is_depth)
        fetched = sum(words[ref] for ref in self.step.fetched)
        written = colour - sum(words[ref] for ref in self.step.keeps) + depth * self.writes_depth
        tested = bool(self.step.state.depth_test or self.step.state.stencil)
        self.work.update({
            "rasterized": rasterized * geometry, "passed": passed, "words_written": passed * written,
            "words_read": passed * (colour if self.step.state.blend else fetched)
            + depth * tested * (rasterized if geometry else self._pixels)})

    @property
    def _pixels(self) -> int:
        """Pixels of the band, of the region, of all listed tiles in it at most, or of the viewport."""
        *_, columns, rows = self._extent or (0, 0, *self._viewport)
        listed = int(self.frame.words(TILE_COMMAND)[0]) * LISTED**2 if self.step.by_tile else self.frame.stats.P
        return min(columns * rows, listed)

    @property
    def _viewport(self) -> tuple[int, int]:
        return self.frame.stats.W, self.frame.stats.H

    def _add_clears(self) -> None:
        viewport = self.frame.stats.P
        *_, columns, rows = self._extent or (0, 0, *self._viewport)
        beside = self.step.kind == "clear" and self.step.region and not self._band
        pixels = viewport - columns * rows if beside else columns * rows
        for ref in self.step.clears:
            words = self.frame.allocation.texture(ref, 0).bytes // 4
            self.work.update({"cleared": pixels, "words_written": words * pixels // viewport})
