"""The cells of one scene, on the device of this process: prepared, sampled in turns, each row emitted as it is done."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from statistics import fmean, median

from ..measure.elimination import LATE
from ..measure.sampling import Sampler
from ..methods.spec import MSAA_FEATURES, Fitted, Method, SceneStats
from ..plan import expected_stats, judge
from ..scene import Scene
from ..scene.kinds import kind_of
from ..store.journal import Partial
from .bench import Bench, Phases
from .cell import CellWork
from .eliminating import Rounds
from .events import BETWEEN, Begun, Finished, Group, Synced
from .jobs import Job
from .outcome import failure, scene_values
from .precompile import drawable
from .scene_work import SceneWork

LIVE_BYTES = 4 * 2**30  # of methods that are interleaved; more are measured in turns
PREPARING_SHARE = 0.6  # of the pooled time of an elimination, at most, to prepare cells
SAMPLING_SHARE = 0.5  # of a cell's time limit, for its sampling: configs/smoke.yaml took 0.58 of 0.2 s, a short limit
LIVE_SHARE = 0.5  # of the memory that the process may take, at most, for the same


def _deadlines(jobs: Sequence[Job], until: float) -> tuple[float, float]:
    """The times of the monotonic clock by which a scene's cells must be prepared, and the rounds of an elimination end.

    The time limits of the cells are pooled, and end at `until`. Without elimination there is no such deadline.
    """
    pooled_s = sum(job.cell.measure.time_limit_s for job in jobs)
    if not (jobs and jobs[0].cell.measure.eliminate):
        return math.inf, math.inf
    now = time.monotonic()
    left_s = max(0.0, min(pooled_s, until - now))
    return now + PREPARING_SHARE * left_s, now + left_s


def _middle_ms(cell: CellWork) -> float:
    """The median time of a cell's frames so far; infinite without any, so that it comes last."""
    return median(cell.sampler.samples_ms) if cell.sampler.samples_ms else math.inf


class DeviceLost(Exception):  # noqa: N818 - what happened, not what is wrong with a call
    """The device answers no more: this process can measure nothing else."""


class Measuring:
    """Measures groups of cells; every event goes to the bench's `emit`.

    Once the bench is `interrupted`, `group` raises KeyboardInterrupt between two frames, after it has emitted what can
    be kept.
    """

    def __init__(self, bench: Bench, catalog: Mapping[str, Method]):
        self.bench, self.catalog = bench, catalog
        self._shuffle = random.Random(0).shuffle  # noqa: S311 - an order, not a secret

    def group(self, group: Group) -> None:
        """Measure the cells of one scene. Raises DeviceLost, after the row of the cell that lost it is emitted."""
        self._partials, self._replicates = group.partials, list(group.replicates)
        self._until = group.until
        self._prepared_by, self._deadline = _deadlines(group.jobs, group.until)
        self._then, self._ended = group.then, []
        self._live_bytes = min(LIVE_BYTES, LIVE_SHARE * group.most_bytes)
        self.bench.emit(Begun(None, "scene"))
        config = group.jobs[0].cell.scene
        if lacks := kind_of(config).lacks(config) or self._lacks(config):
            for job in group.jobs:
                self.bench.emit(Finished(job.key, "unsupported", f"needs {lacks}", values={}))
            return
        try:
            scene = SceneWork(self.bench, config)
        except MemoryError as error:
            for job in group.jobs:
                self.bench.emit(Finished(job.key, *failure(error), values={}))
            return
        try:
            allowed = [job for job in group.jobs if not self._skipped(job, scene.stats)]
            scene.prepare(self._fitted(job, scene.stats).variant for job in allowed)
            self.bench.precompiler.begin([job for job in allowed if drawable(job, self._fitted(job, scene.stats))],
                                         self._drawable_later())
            for chunk in self._chunks(allowed, scene.stats):
                left: Sequence[Job] = chunk
                while left:
                    left = self._chunk(left, scene)
        finally:
            scene.release()

    def _lacks(self, config: Scene) -> str | None:
        """The samples a pixel that the device lacks: it could not even count the fragments of such a scene."""
        feature, limits = MSAA_FEATURES.get(expected_stats(config).samples), self.bench.device.limits
        return limits.lacks(feature) if feature and feature not in limits.features else None

    def _fitted(self, job: Job, stats: SceneStats) -> Fitted:
        variant = self.catalog[job.cell.method].variant(job.cell.params)
        return Fitted(variant, stats, self.bench.device.limits.features)

    def _drawable_later(self) -> list[Job]:
        """The cells of the scene that follows which another process may draw, as far as its plan tells."""
        stats = expected_stats(self._then[0].cell.scene) if self._then else None
        return [job for job in self._then if drawable(job, self._fitted(job, stats)) and not judge(
            job.cell, self.catalog, stats, self.bench.device.limits)]

    def _tell(self, finished: Finished) -> None:
        self.bench.emit(finished)
        self.bench.emit(Synced())

    def _skipped(self, job: Job, stats: SceneStats) -> bool:
        """Decide without compiling or allocating anything whether the device or the budget forbids the cell."""
        decision = judge(job.cell, self.catalog, stats, self.bench.device.limits)
        if decision:
            self.bench.emit(Finished(job.key, *decision, values=scene_values(self._fitted(job, stats))))
        return decision is not None

    def _chunks(self, todo: Sequence[Job], stats: SceneStats) -> Iterator[list[Job]]:
        """Jobs in order, as many together as fit the memory for interleaving."""
        chunk: list[Job] = []
        held = 0
        for job in todo:
            needed = sum(self._fitted(job, stats).memory_bytes().values())
            if chunk and held + needed > self._live_bytes:
                yield chunk
                chunk, held = [], 0
            chunk.append(job)
            held += needed
        if chunk:
            yield chunk

    def _chunk(self, chunk: Sequence[Job], scene: SceneWork) -> Sequence[Job]:
        """Measure the first of these cells, as many as can be sampled before the run must end. Returns the others."""
        running: list[CellWork] = []
        left = list(chunk)
        try:
            took_s: list[float] = []
            while left and not self._has_enough(running):
                job = left.pop(0)
                begun = time.monotonic()
                self._prepare(job, scene, running, begun + (fmean(took_s) if took_s else 0.0))
                took_s.append(time.monotonic() - begun)
            if self._then:
                self.bench.ahead.begin(self._then[0].cell.scene)
            self.bench.emit(Synced())  # until here the parent may have worked on what was sent before
            self._sample(running)
        except KeyboardInterrupt:
            for cell in sorted(running, key=_middle_ms):
                enough = cell.sampler.interrupt()
                if enough or (cell.sampler.samples_ms and time.monotonic() >= self._until):
                    self._guarded(cell, self._finish)
            raise
        finally:
            try:
                self._tell_ended(wait=True)
            finally:
                for cell in running:
                    cell.frame.release()
        return left

    def _has_enough(self, running: Sequence[CellWork]) -> bool:
        """Whether sampling what is prepared may take all the time that is left. One cell is always prepared."""
        needed_s = SAMPLING_SHARE * sum(cell.job.cell.measure.time_limit_s for cell in running)
        eliminates = any(cell.job.cell.measure.eliminate for cell in running)  # which has a time of its own to prepare
        return bool(running) and not eliminates and time.monotonic() + needed_s >= self._until

    def _prepare(self, job: Job, scene: SceneWork, running: list[CellWork], expected: float) -> None:
        """Compile, allocate, draw once and check the image; a cell that fails ends as its row.

        expected: when this is done if it takes as long as the cells before; one that would be late is not begun.
        """
        self.bench.stop_if_asked()
        self.bench.precompiler.reached(job)
        self._look(job)
        fitted = self._fitted(job, scene.stats)
        if expected > self._prepared_by:
            self._tell(Finished(job.key, "timeout", LATE, values=scene_values(fitted)))
            return
        try:
            running.append(CellWork(self.bench, scene, job, fitted, self._partials.get(job.key, Partial())))
        except Exception as error:  # noqa: BLE001 - whatever it is, it is this cell's result
            self._fail(job, error, scene_values(fitted))
        else:
            self.bench.precompiler.drew(job, running[-1].first_cpu_s)

    def _look(self, job: Job) -> None:
        """Look at the reference frame, so that its best is known before the first turn that it is compared with."""
        if not (job.cell.measure.eliminate or job.cell.measure.single):
            Phases(self.bench, job.key).begin(BETWEEN)
            with self.bench.split.work("reference"):
                self.bench.watch.look_seldom()

    def _sample(self, running: list[CellWork]) -> None:
        """Feed all samplers in rounds of random order, so that drift hits all alike; finish each as it is done.

        Turns during which the device was slower are taken again in later rounds. The run waits only where nothing else
        is left to do. What compiles ahead goes on while cells are finished: to stop it takes longer than many a turn.
        """
        if running and running[0].job.cell.measure.eliminate:
            rounds = Rounds(running, self._guarded, self._shuffle, lambda: self.bench.emit(Synced()), self._deadline)
            with self.bench.precompiler.paused():
                rounds.run(self._finish_apart)
            running = rounds.apart
        entries = [(cell, cell.sampler) for cell in running]
        while entries:
            self._shuffle(entries)
            with self.bench.precompiler.paused():
                for cell, sampler in entries:  # between which the process that compares images goes on
                    self._guarded(cell, partial(self._batch, sampler=sampler))
                with self.bench.paused(), self.bench.split.work("reference"):
                    self.bench.watch.look_behind()
                self._start_pairs(running)
                ending = [cell for cell in running if not (cell.done or cell.wanted or cell.take_again())]
                for cell in ending:
                    self._guarded(cell, CellWork.time_passes)
            for cell in ending:  # while the last frames are drawn, rows may be written
                self._guarded(cell, self._finish)
            self._tell_ended()
            self.bench.emit(Synced())
            entries = [(cell, s) for cell in running if not cell.done for s in cell.samplers if s.wanted]
            if entries and all(cell.postponed for cell, _ in entries):
                self._guarded(entries[0][0], CellWork.wait)

    def _start_pairs(self, running: Sequence[CellWork]) -> None:
        """Let one cell of each experiment be sampled twice more; what the two differ by is the noise floor.

        It is the one in the middle of the frame times, which all have shown by now: the shortest frames scatter most.
        """
        for keys in self._replicates:
            able = [cell for cell in running if cell.job.key in keys and not cell.done and cell.images.promised]
            if able and not any(cell.twice for cell in able):
                sorted(able, key=_middle_ms)[len(able) // 2].sample_twice()
        taken = {cell.job.key for cell in running if cell.twice}
        self._replicates = [keys for keys in self._replicates if not taken & keys]

    def _guarded(self, cell: CellWork, step: Callable[[CellWork], None]) -> None:
        """Run a step of a cell that is not done; what goes wrong in it costs that cell alone."""
        if cell.done:
            return
        try:
            step(cell)
        except Exception as error:  # noqa: BLE001 - whatever it is, it is this cell's result
            cell.done = True
            self._fail(cell.job, error, scene_values(cell.fitted))

    def _batch(self, cell: CellWork, sampler: Sampler) -> None:
        if sampler.wanted:
            cell.batch(sampler)

    def _finish_apart(self, cell: CellWork) -> None:
        """End a cell while others are sampled: its row is written before they go on."""
        self._finish(cell)
        self.bench.emit(Synced())

    def _finish(self, cell: CellWork) -> None:
        cell.end()
        cell.done = True
        self._ended.append(cell)
        self._tell_ended()

    def _tell_ended(self, wait: bool = False) -> None:
        """Emit the rows of the cells whose images are compared, or with `wait` of all that have ended."""
        told = [cell for cell in self._ended if wait or cell.ready]
        for cell in told:
            self._ended.remove(cell)
            try:
                self.bench.emit(cell.finished())
            except Exception as error:  # noqa: BLE001 - as above
                self._fail(cell.job, error, scene_values(cell.fitted))
        if wait and told:
            self.bench.emit(Synced())

    def _fail(self, job: Job, error: Exception, values: Mapping[str, object]) -> None:
        """The cell's row; after an error that may be the device's, whether that is still there."""
        self._tell(Finished(job.key, *failure(error), values=values))
        if not self.bench.device.alive():
            raise DeviceLost
