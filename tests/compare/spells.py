"""Runs on a machine whose host gives its memory to others for seconds at a time: cells sampled in turns, and watched.

Frames that move much data are slowed down then, those that mostly compute are not; the reference frame feels it as much
as any, but for a tenth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from random import Random

from mfr_bench.gpu.reference import shortest_ms
from mfr_bench.measure.sampling import Sampler
from mfr_bench.measure.watch import Turn, Watch

from .loaded import CV, GROWTH, LOAD, MEASURE, METHODS, SHIFT, SHORTEST_MS
from .planted import SCENES, cell, side

GAP_S, SPELL_S = 20.0, 8.0  # between spells, and of spells, in the mean
SLOWED = (1.0, 2.0)  # times as long
ALIKE_MS = 300.0  # for which a spell is as strong
MOST_FELT = 1.1  # power of that; the least is 0, that of the reference 1
PREPARED_MS = 3000.0  # before a scene is sampled
REFERENCE_MS = 0.25


@dataclass
class Host:
    """The clock of a machine, and the spells in which its host slows it down, now more and now less."""

    random: Random
    now_ms: float = 0.0

    def __post_init__(self):
        self._in_spell = self.random.random() < GAP_S / (GAP_S + SPELL_S)
        self._factor, self._until_ms, self._spell_until_ms = 1.0, 0.0, 0.0

    def _go_on(self):
        """Begin what follows: a gap, a spell, or another strength of it."""
        if self._until_ms >= self._spell_until_ms:
            self._in_spell = not self._in_spell
            self._spell_until_ms += 1e3 * self.random.expovariate(1 / (SPELL_S if self._in_spell else GAP_S))
        self._factor = self.random.uniform(*SLOWED) if self._in_spell else 1.0
        lasts_ms = self.random.expovariate(1 / ALIKE_MS) if self._in_spell else 1e9
        self._until_ms = min(self._until_ms + lasts_ms, self._spell_until_ms)

    def frame(self, whole_ms: float, felt: float = 1.0) -> float:
        """The time of a frame that takes so long by itself, and feels a power of what slows the machine."""
        while self.now_ms >= self._until_ms:
            self._go_on()
        own = whole_ms * self.random.lognormvariate(0, CV) * self._factor**felt
        self.now_ms += own
        return own

    def sleep(self, seconds: float) -> None:
        self.now_ms += 1e3 * seconds

    def watch(self) -> Watch:
        """Look at the reference as a run does."""
        return Watch(lambda best_ms: shortest_ms(lambda: self.frame(REFERENCE_MS), best_ms),
                     lambda: self.now_ms / 1e3, self.sleep)


def run(seed: int, method: int = 0, scene: int = 0, factor: float = 1.0, wait_s: float = 0.0):
    """A run of 28 cells as a side of a comparison; the frames of one are `factor` times as long."""
    random = Random(seed)  # noqa: S311 - no secret
    host, load, cells = Host(random), random.lognormvariate(0, LOAD), []
    watch = host.watch()
    for layers in SCENES:
        for _ in range(METHODS):
            host.now_ms += PREPARED_MS / METHODS
            watch.look()
        whole_ms = [load * SHORTEST_MS * GROWTH**m * layers / 16 * random.lognormvariate(0, SHIFT)
                    * (factor if (m, layers) == (method, scene) else 1.0) for m in range(METHODS)]
        for m, (sampler, references_ms) in enumerate(_sampled(host, watch, whole_ms, wait_s)):
            cells.append(cell(f"m{m}", sampler.samples_ms, {"depth_complexity": layers})
                         | {"references_ms": references_ms})
    return side(cells)


def _sampled(host: Host, watch: Watch, whole_ms: Sequence[float], wait_s: float):
    """The samplers of cells that take turns, each with the references of its samples."""
    felts = [5 * m % METHODS / (METHODS - 1) * MOST_FELT for m in range(METHODS)]
    every: list[tuple[Sampler, list[Turn], float]] = [(Sampler(MEASURE), [], felt) for felt in felts]
    wanted = list(zip(every, whole_ms, strict=True))
    while wanted:
        host.random.shuffle(wanted)
        kept = 0
        for (sampler, turns, felt), frame_ms in wanted:
            first = len(sampler.samples_ms)
            with watch.turn() as turn:
                for _ in sampler.turn():
                    sampler.add(host.frame(frame_ms, felt))
            if watch.slower(turn) and watch.again(turn.took_s, wait_s):
                sampler.set_aside(range(first, len(sampler.samples_ms)))
            else:
                turns.extend([turn] * (len(sampler.samples_ms) - first))
                kept += sampler.wanted > 0
        watch.look_behind()
        for sampler, turns, _ in every:
            slow = [n for n, turn in enumerate(turns) if watch.slower(turn)]
            if not sampler.wanted and slow and watch.again(sum(sampler.samples_ms[n] for n in slow) / 1e3, wait_s):
                sampler.set_aside(slow)
                turns[:] = [turn for turn in turns if not watch.slower(turn)]
        wanted = [(mine, frame_ms) for mine, frame_ms in zip(every, whole_ms, strict=True) if mine[0].wanted]
        if wanted and not kept:
            watch.wait(wait_s, lambda: None)
    return [(sampler, [turn.reference_ms for turn in turns]) for sampler, turns, _ in every]
