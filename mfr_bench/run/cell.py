"""One cell on the device: prepared, sampled batch by batch, ended; its row, once its images are compared."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ..config.settings import Measure
from ..gpu.frame import Frame
from ..gpu.timers import repeats_for, undisturbed_ms
from ..gpu.work import work_of
from ..measure.sampling import Sampler
from ..measure.watch import Turn, Unwatched
from ..methods.spec import Fitted
from ..oracle import twochannel
from ..plan.forecast import PASS_SHARE, pass_frames
from ..stats import apart
from ..store.journal import Partial
from .bench import Bench, Phases
from .events import BETWEEN, WAIT, Finished, Sampled
from .images import Images
from .jobs import Job
from .outcome import fragment_shares, frame_values, scene_values, verdict
from .scene_work import SceneWork

PAIR_LEAST = 22  # samples of each side of an A/A pair, which the first batch takes in three turns


def pair_of(measure: Measure) -> tuple[Sampler, Sampler]:
    """Two samplers of one thing that are to take turns: an A/A pair."""
    least = min(max(PAIR_LEAST, measure.min_samples), measure.max_samples)
    return Sampler(replace(measure, min_samples=least)), Sampler(replace(measure, min_samples=least))


def noise_floor_rel(one: Sampler, other: Sampler) -> float | None:
    """How far the two of an A/A pair are apart, relative; None where they have too few samples."""
    return apart(other.samples_ms, one.samples_ms, one.measure.min_samples, one.measure.max_samples)


class CellWork:
    """A cell that has drawn its first image and is being sampled. `partial`: what earlier processes took of it."""

    def __init__(self, bench: Bench, scene: SceneWork, job: Job, fitted: Fitted, partial: Partial):
        self.bench, self.scene, self.job, self.fitted, self.variant = bench, scene, job, fitted, fitted.variant
        self.sampler = Sampler(job.cell.measure)
        self.sampler.resume(partial.samples_ms)
        self._watch = Unwatched() if job.cell.measure.single else bench.watch
        self._pair: tuple[Sampler, ...] = ()  # an A/A pair: the same twice more, for the noise floor
        self._turns: list[list[Turn]] = [[]]  # of each sampler, for each sample that this process took
        self.passes = {name: list(times_ms) for name, times_ms in partial.passes.items()}
        self.passes_s = sum(map(sum, self.passes.values())) / 1e3  # spent on timing passes
        self.done = False  # nothing more is drawn for it
        self.postponed = False  # the last turn is to be taken again: the device was slower
        self._last_checked = False  # whether the image of the last sample is checked
        self.repeats = 1  # frames in a sample
        self.pass_frames = pass_frames(job.cell.measure)  # frames whose passes are timed
        self._emitted = len(self.sampler.samples_ms)  # samples already sent
        self._phases = Phases(bench, job.key)
        self.frame = self._drawn()
        try:
            self.images = Images(bench, self._phases, scene, job, self.variant, self.frame)
        except BaseException:
            self.frame.release()
            raise
        self._phases.begin(BETWEEN)

    @property
    def samplers(self) -> list[Sampler]:
        return [self.sampler, *self._pair]

    @property
    def twice(self) -> bool:
        """Whether an A/A pair is sampled, too."""
        return bool(self._pair)

    @property
    def wanted(self) -> bool:
        return not self.done and any(s.wanted for s in self.samplers)

    @property
    def memory_bytes(self) -> int:
        """Bytes of all objects that the method has allocated."""
        return sum(self.frame.memory_bytes.values())

    def _drawn(self) -> Frame:
        """Compile, allocate, and draw until everything fits."""
        scene, device = self.scene, self.bench.device
        scene.show(0)
        device.times_frames = not self.job.cell.measure.single
        self._phases.begin("compile")
        begun, begun_cpu_s = time.perf_counter(), time.process_time()
        with self.bench.split.work("compile"):
            frame = Frame(device, self.fitted, scene.scene_buffer, scene.canvas)
            try:
                self._phases.begin("first frame")
                frame.draw_fitting()
                device.finish()
                device.check(f"{self.job.cell.method}: first frame")
            except BaseException:
                frame.release()
                raise
        self._first_s, self._first_frames = time.perf_counter() - begun, frame.drawn
        self.first_cpu_s = time.process_time() - begun_cpu_s
        return frame

    def _count_as_frames(self, taken_s: float, frames: int, of: str, to: str) -> None:
        """Count as the device's, of the time of frames in which the driver compiled, what as many later frames take."""
        middle_ms = self.sampler.interval[1]
        if middle_ms is not None:
            self.bench.split.move(min(taken_s, frames * middle_ms / 1e3), of, to)

    def sample_twice(self) -> None:
        """Sample an A/A pair too from now on, in turns with each other and with the cells of the scene."""
        self._pair = pair_of(self.job.cell.measure)
        self._turns += [[] for _ in self._pair]

    def batch(self, sampler: Sampler) -> None:
        """Draw as many frames as the sampler wants next; if it is warm, also one whose passes are timed."""
        self._phases.begin(BETWEEN)
        first, watch = len(sampler.samples_ms), self._watch
        self._last_checked = self._last_checked and sampler is not self.sampler
        with self.bench.paused():
            with self.bench.split.work("reference"), watch.turn() as turn, self._phases.within("sampling"):
                self._take(sampler)
            self.postponed = watch.slower(turn) and watch.again(turn.took_s, sampler.measure.wait_s)
            if self.postponed:
                sampler.set_aside(range(first, len(sampler.samples_ms)))
            else:
                self._turns_of(sampler).extend([turn] * (len(sampler.samples_ms) - first))
            ends = sampler is self.sampler and not (sampler.wanted or self.postponed)
            times_passes = sampler.warm and not self.postponed and self._lacks_passes
            image, passes = None, {}
            if ends or times_passes:
                with self._phases.within("sampling"):
                    image = self.images.of_sample() if ends else None
                    passes = self._time_passes(1) if times_passes else {}
        self._emit_new(passes)
        if image is not None:
            self.images.check(image)
            self._last_checked = True

    def _take(self, sampler: Sampler) -> None:
        """Draw the frames of one turn, the first of which find the samplers as those of any turn do."""
        self.bench.device.settle()
        for _ in sampler.turn():
            self.bench.stop_if_asked()
            self.frame.show(self.scene.show(len(sampler.samples_ms)))
            with self.bench.split.work("measure" if sampler.warm else "warm-up"):
                sampler.add(self._sample(sampler.warm))

    def wait(self) -> None:
        """Wait until the device is as fast as usual, which counts as no time of the method."""
        with self._phases.apart(WAIT), self.bench.paused():
            self._watch.wait(self.sampler.measure.wait_s, self.bench.stop_if_asked)

    def _turns_of(self, sampler: Sampler) -> list[Turn]:
        return next(turns for one, turns in zip(self.samplers, self._turns, strict=True) if one is sampler)

    def take_again(self) -> bool:
        """Take samples back that were taken while the device was slower than its best, as later looks have shown.

        Whether there were any, and time to take them again.
        """
        taken = [self._take_back(sampler) for sampler in self.samplers]
        self.postponed = any(taken)
        self._emitted = min(self._emitted, len(self.sampler.samples_ms))
        return self.postponed

    def _take_back(self, sampler: Sampler) -> bool:
        watch, turns = self._watch, self._turns_of(sampler)
        earlier = len(sampler.samples_ms) - len(turns)
        slow = [earlier + number for number, turn in enumerate(turns) if watch.slower(turn)]
        if not slow or not watch.again(sum(sampler.samples_ms[number] for number in slow) / 1e3,
                                       sampler.measure.wait_s):
            return False
        sampler.set_aside(slow)
        turns[:] = [turn for turn in turns if not watch.slower(turn)]
        return True

    def warm_up(self, frames: int) -> None:
        """Draw frames that count for nothing."""
        self._phases.begin("sampling")
        for _ in range(frames):
            self.bench.stop_if_asked()
            with self.bench.paused(), self.bench.split.work("warm-up"):
                self.sampler.warmup_ms.append(self._sample(warm=False))

    def round(self) -> float:
        """The time of one frame that no other process held up, in ms, taken as a sample."""
        self._phases.begin("sampling")
        self.bench.stop_if_asked()
        self.frame.show(self.scene.show(len(self.sampler.samples_ms)))
        self.bench.device.settle()
        with self.bench.paused(), self.bench.split.work("measure"):
            time_ms = undisturbed_ms(self.bench.timer, self.frame.draw, self.repeats)
        self.sampler.take(time_ms)
        return time_ms

    def emit_samples(self) -> None:
        """Emit what was sampled since the last time."""
        self._emit_new({})

    def _sample(self, warm: bool) -> float:
        """The time of a frame, in ms. The warm-up shows how many the clock needs in a sample."""
        timer = self.bench.timer
        time_ms = timer.frame_ms(self.frame.draw, self.repeats)
        if not warm:
            self.repeats = max(self.repeats, repeats_for(time_ms, timer.resolution_ms))
        return time_ms

    def _emit_new(self, passes: Mapping[str, tuple[float, ...]]) -> None:
        """Emit the samples that are new since the last batch, and the times of passes, in ms."""
        samples, self._emitted = self.sampler.samples_ms[self._emitted:], len(self.sampler.samples_ms)
        if samples or passes:
            self.bench.emit(Sampled(self.job.key, tuple(samples), passes))

    @property
    def _lacks_passes(self) -> bool:
        """Whether passes are to be timed in more frames, and time is left for one."""
        done = len(next(iter(self.passes.values()), ()))
        return done < self.pass_frames and self.passes_s <= PASS_SHARE * self.job.cell.measure.time_limit_s

    def _time_passes(self, frames: int) -> dict[str, tuple[float, ...]]:
        """Time the passes in frames of their own, between the batches, so that drift hits both alike."""
        new: dict[str, tuple[float, ...]] = {}
        with self.bench.split.work("passes"):
            for _ in range(frames):
                if not self._lacks_passes:
                    break
                self.frame.show(self.scene.show(len(self.sampler.samples_ms)))
                times = self.bench.timer.passes_ms(self.frame.draw)
                self.passes_s += sum(times.values()) / 1e3
                for name, time_ms in times.items():
                    self.passes.setdefault(name, []).append(time_ms)
                    new[name] = (*new.get(name, ()), time_ms)
        return new

    def time_passes(self) -> None:
        """Time the passes in as many frames as the batches have left to do."""
        self._phases.begin(BETWEEN)
        if self._lacks_passes:
            with self.bench.paused():
                self._phases.begin("passes")
                self.bench.device.settle()
                self._time_passes(self.pass_frames)
            self._phases.begin(BETWEEN)

    def end(self) -> None:
        """Time the passes and draw the last images; nothing is drawn for the cell afterwards."""
        self.time_passes()
        self._phases.begin("last frames")
        with self.bench.split.work("last frames"):
            if self.scene.animated:
                self.frame.show(self.scene.show(-1))
                self.images.draw_again()
            self.frame.show(self.scene.show(0))
            if not self._last_checked:
                self.images.draw_again()
            self.images.count_lost()
            self.images.draw_several()
            self.images.keep()
            if self.fitted.stats.effect.msaa > 1:
                self.images.count_edges()
            self._measured, self._also = self._values(), self._details()
        self._phases.begin(BETWEEN)
        self._count_as_frames(self._first_s, self._first_frames, "compile", "first frames")
        self._count_as_frames(self._counting_s, self._counting_frames, "count", "counting frames")

    @property
    def ready(self) -> bool:
        """Whether all images of a cell that has ended are compared."""
        return self.images.ready

    def finished(self) -> Finished:
        """The row of a cell that has ended; waits for its images to be compared."""
        values, distinct, kept = self._measured | self.images.errors(), self.images.distinct(), self.images.kept()
        values["distinct_images"] = distinct
        if self.fitted.stats.effect.msaa > 1:
            values["edge_pixels"] = self.images.edge_pixels()
        if kept.discarded is not None and self.scene.first.F:
            values["culled_share"] = kept.discarded / self.scene.first.F
        status, reason = verdict(self.fitted, values, self.images.lost, distinct or 1)
        return Finished(self.job.key, status, reason, values, self._also, kept.content,
                        noise_floor_rel(*self._pair) if self._pair else None)

    def _values(self) -> dict[str, Any]:
        """The values of the row's columns, but for what is found by comparing images."""
        sampler = self.sampler
        low, middle, high = sampler.interval
        found = scene_values(self.fitted) | {
            "samples": len(sampler.samples_ms), "timer": self.bench.timer.name, "time_ms": middle, "time_ms_low": low,
            "time_ms_high": high, "noisy": sampler.noisy, "stop_reason": sampler.stop_reason,
            "repeats": self.repeats, "memory_bytes": self.memory_bytes,
            "lost_fragments": self.images.lost, "geometry_passes": self.frame.geometry_passes,
            "error_bound": self.fitted.error_bound(),
        }
        if self.variant.two_channel:
            found |= twochannel.errors(self.scene.scene_buffer.scene.rgba)
        begun, drawn = time.perf_counter(), self.frame.drawn
        with self.bench.split.work("count"):
            found |= fragment_shares(self.frame, self.variant, self.scene.shown)
        self._counting_s, self._counting_frames = time.perf_counter() - begun, self.frame.drawn - drawn
        return found

    def _details(self) -> dict[str, Any]:
        """The parts of the record that are no columns: every sample, the times of passes, buffers, frames, counters."""
        every = [Fitted(self.variant, stats) for stats in self.scene.frames]
        found = {"warmup_ms": self.sampler.warmup_ms, "samples_ms": self.sampler.samples_ms, "passes": self.passes,
                 "buffers": self.frame.memory_bytes, "frames": frame_values(every)}
        if references_ms := [round(turn.reference_ms, 4) for turn in self._turns[0] if turn.reference_ms is not None]:
            found |= {"references_ms": references_ms, "aside_ms": self.sampler.aside_ms}
        if self.job.cell.measure.counters:
            with self.bench.split.work("count"):
                found["work"] = work_of(self.frame)
        return found
