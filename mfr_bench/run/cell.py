"""One cell on the device: prepared, checked against the oracle, sampled batch by batch, finished as its row."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..errors import CapacityError, MfrError
from ..gpu.context import Device
from ..gpu.frame import Frame
from ..gpu.timers import Timer, repeats_for
from ..gpu.work import admitted_map, work_of
from ..measure.sampling import Sampler
from ..measure.split import Split
from ..methods.spec import Fitted, Variant
from ..oracle import quality, twochannel
from ..plan.forecast import PASS_FRAMES, PASS_SHARE
from ..stats import interleaved_ratio
from ..store.journal import Partial
from ..store.status import EXACT_ERROR
from .events import CHECK, Begun, Finished, Sampled
from .jobs import Job
from .scene_work import ALL, SceneWork

Emit = Callable[[Any], None]


@dataclass
class Bench:
    """The device and the timer of every cell, and `emit`, which receives the events of its measurement."""

    device: Device
    timer: Timer
    emit: Emit
    interrupted: Callable[[], bool] = lambda: False
    split: Split = field(default_factory=Split)

    def stop_if_asked(self) -> None:
        if self.interrupted():
            raise KeyboardInterrupt


class CellWork:
    """A cell that passed its first check and is being sampled. `partial`: what earlier processes took of it."""

    def __init__(self, bench: Bench, scene: SceneWork, job: Job, fitted: Fitted, partial: Partial):
        self.bench, self.scene, self.job, self.fitted, self.variant = bench, scene, job, fitted, fitted.variant
        self.sampler = Sampler(job.cell.measure)
        self.sampler.resume(partial.samples_ms)
        self.replicate: Sampler | None = None  # the A/A replicate: the same again, for the noise floor
        self.passes = {name: list(times_ms) for name, times_ms in partial.passes.items()}
        self.passes_s = sum(map(sum, self.passes.values())) / 1e3  # spent on timing passes
        self.done = False  # its result was sent
        self.repeats = 1  # frames in a sample
        self.pass_frames = PASS_FRAMES  # frames whose passes are timed
        self._emitted = len(self.sampler.samples_ms)  # samples already sent
        self.frame = self._drawn()
        try:
            self._check()
        except BaseException:
            self.frame.release()
            raise

    @property
    def samplers(self) -> list[Sampler]:
        return [s for s in (self.sampler, self.replicate) if s]

    @property
    def wanted(self) -> bool:
        return not self.done and any(s.wanted for s in self.samplers)

    @property
    def share(self) -> float:
        """How much of the most frames or time that it may take has been taken."""
        return 0.0 if self.done else min(s.share for s in self.samplers)

    @property
    def checked(self) -> bool:
        """Whether the method promises an image."""
        return self.variant.method.guarantee != "none"

    @property
    def memory_bytes(self) -> int:
        """Bytes of all objects that the method has allocated."""
        return sum(self.frame.memory_bytes.values())

    def _begin(self, phase: str) -> None:
        self._phase = phase
        self.bench.emit(Begun(self.job.key, phase))

    def _drawn(self) -> Frame:
        """Compile, allocate, and draw until everything fits."""
        scene, device = self.scene, self.bench.device
        scene.show(0)
        self._begin("compile")
        with self.bench.split.work("compile"):
            frame = Frame(device, self.fitted, scene.scene_buffer, scene.canvas)
            try:
                self._begin("first frame")
                frame.draw_fitting()
                device.finish()
                device.check(f"{self.job.cell.method}: first frame")
            except BaseException:
                frame.release()
                raise
        return frame

    def _check(self) -> None:
        image = self.frame.image()
        self.lost = self.frame.lost_in_a_frame()
        with self._checking():
            self.conformance = self._conformance(image)
            self.quality = self.scene.quality(image, not self.job.cell.measure.eliminate) if self.checked else {}

    @contextmanager
    def _checking(self):
        """The harness's own work on images, which counts as no time of the method."""
        before = self._phase
        self._begin(CHECK)
        with self.bench.split.work("check"):
            yield
        self._begin(before)

    def _conformance(self, image) -> dict[str, float | int]:
        return self.scene.conformance(self.variant, image) if self.checked else {}

    def batch(self, sampler: Sampler) -> None:
        """Draw as many frames as the sampler wants next; if it is warm, also one whose passes are timed."""
        self._begin("sampling")
        for _ in sampler.turn():
            self.bench.stop_if_asked()
            self.frame.show(self.scene.show(len(sampler.samples_ms)))
            with self.bench.split.work("measure" if sampler.warm else "warm-up"):
                sampler.add(self._sample(sampler.warm))
        self._tell(self._time_passes(1) if sampler.warm else {})

    def warm_up(self, frames: int) -> None:
        """Draw frames that count for nothing."""
        self._begin("sampling")
        for _ in range(frames):
            self.bench.stop_if_asked()
            with self.bench.split.work("warm-up"):
                self.sampler.warmup_ms.append(self._sample(warm=False))

    def round(self) -> float:
        """The time of one frame, in ms, taken as a sample."""
        self._begin("sampling")
        self.bench.stop_if_asked()
        self.frame.show(self.scene.show(len(self.sampler.samples_ms)))
        with self.bench.split.work("measure"):
            time_ms = self._sample(warm=True)
        self.sampler.take(time_ms)
        return time_ms

    def tell(self) -> None:
        """Say what was sampled since the last time."""
        self._tell({})

    def _sample(self, warm: bool) -> float:
        """The time of a frame, in ms. The warm-up shows how many the clock needs in a sample."""
        timer = self.bench.timer
        time_ms = timer.frame_ms(self.frame.draw, self.repeats)
        if not warm:
            self.repeats = max(self.repeats, repeats_for(time_ms, timer.resolution_ms))
        return time_ms

    def _tell(self, passes: Mapping[str, float]) -> None:
        """What is new since the last batch."""
        samples, self._emitted = self.sampler.samples_ms[self._emitted:], len(self.sampler.samples_ms)
        if samples or passes:
            self.bench.emit(Sampled(self.job.key, tuple(samples), passes))

    def _time_passes(self, frames: int) -> dict[str, tuple[float, ...]]:
        """Time the passes in frames of their own, between the batches, so that drift hits both alike."""
        limit_s = PASS_SHARE * self.job.cell.measure.time_limit_s
        done = len(next(iter(self.passes.values()), ()))
        new: dict[str, tuple[float, ...]] = {}
        with self.bench.split.work("passes"):
            for _ in range(min(frames, self.pass_frames - done)):
                if self.passes_s > limit_s:
                    break
                self.frame.show(self.scene.show(len(self.sampler.samples_ms)))
                times = self.bench.timer.passes_ms(self.frame.draw)
                self.passes_s += sum(times.values()) / 1e3
                for name, time_ms in times.items():
                    self.passes.setdefault(name, []).append(time_ms)
                    new[name] = (*new.get(name, ()), time_ms)
        return new

    def finish(self) -> Finished:
        """Time the passes, check the image once more: the row."""
        self._begin("passes")
        self._time_passes(self.pass_frames)
        self._begin("last frames")
        self._check_again()
        distinct = self._distinct_images()
        status, reason = verdict(self.variant, self.conformance, self.lost, distinct or 1)
        sampler, frame = self.sampler, self.frame
        low, middle, high = sampler.interval
        values = scene_values(self.fitted) | self.conformance | self.quality | {
            "samples": len(sampler.samples_ms), "timer": self.bench.timer.name, "time_ms": middle, "time_ms_low": low,
            "time_ms_high": high, "noisy": sampler.noisy, "stop_reason": sampler.stop_reason,
            "repeats": self.repeats, "memory_bytes": self.memory_bytes,
            "lost_fragments": self.lost, "geometry_passes": frame.geometry_passes,
            "distinct_images": distinct, "error_bound": self.fitted.error_bound(), **self._shares(),
        }
        if self.variant.two_channel:
            values |= twochannel.errors(self.scene.scene_buffer.scene.rgba)
        arrays = self._kept_arrays()
        if "discarded" in arrays and self.scene.shown.F:
            values["culled_share"] = float(arrays["discarded"].sum() / self.scene.shown.F)
        details = {"warmup_ms": sampler.warmup_ms, "samples_ms": sampler.samples_ms, "passes": self.passes,
                   "buffers": frame.memory_bytes, "frames": frames(self.variant, self.scene)}
        if self.job.cell.measure.counters:
            details["work"] = work_of(frame)
        return Finished(self.job.key, status, reason, values, details, arrays, self._noise_floor_rel())

    def _kept_arrays(self) -> dict[str, np.ndarray]:
        """What `measure.keep` asks for and the method has, of the last image and the scene on the device."""
        wanted, truth = self.job.cell.measure.keep, self.scene.truth
        found = {}
        if "fragments" in wanted:
            found["fragments"] = truth.counts
        if "discarded" in wanted and (admitted := admitted_map(self.frame)) is not None:
            found["discarded"] = truth.counts - admitted
        if self.checked and {"image", "error", "loss"}.intersection(wanted):
            image = self.frame.image()
            with self._checking():
                made = {"image": np.rint(255 * np.clip(image, 0, 1)),
                        "error": quality.pixel_errors(image, self.scene.promised(self.variant), truth.tied),
                        "loss": quality.pixel_errors(image, self.scene.oracle(ALL))}
            found |= {name: made[name] for name in made if name in wanted}
        return found

    def _check_again(self) -> None:
        """The last image must be as right as the first: the worse of the two counts."""
        self.frame.show(self.scene.show(0))
        self.frame.draw()
        self.lost = max(self.lost, self.frame.lost_in_a_frame())
        self.bench.device.check(f"{self.job.cell.method}: sampling")
        if self.conformance:
            self._hold_against_promise(self.frame.image())

    def _hold_against_promise(self, image: np.ndarray) -> None:
        """Check an image against the promise; the worst of all images that are checked counts."""
        with self._checking():
            again = self._conformance(image)
        self.conformance = {name: max(value, again[name]) for name, value in self.conformance.items()}

    def _noise_floor_rel(self) -> float | None:
        """The largest relative difference between the cell and its A/A replicate; None without one."""
        if self.replicate is None:
            return None
        measure = self.job.cell.measure
        low, _, high = interleaved_ratio(self.replicate.samples_ms, self.sampler.samples_ms, measure.min_samples,
                                         measure.max_samples)
        return None if low is None or high is None else max(abs(low - 1), abs(high - 1))

    def _distinct_images(self) -> int | None:
        """Different images of the scene on the device, where more than one frame is asked for and images compare.

        Each of them is held against the promise.
        """
        wanted = self.job.cell.measure.repeat_images
        if wanted == 1 or not self.conformance:
            return None
        images: set[bytes] = set()
        for _ in range(wanted):
            self.bench.stop_if_asked()
            self.frame.draw()
            image = self.frame.image()
            seen = len(images)
            with self._checking():
                images.add(hashlib.sha256(self.scene.untied(image)).digest())
            if len(images) > seen:
                self._hold_against_promise(image)
        self.lost = max(self.lost, self.frame.lost_in_a_frame())
        return len(images)

    def _shares(self) -> dict[str, float | None]:
        """The shares of the fragments that are kept, that the promise keeps, and that are discarded before the store.

        All are shares of the fragments that the scene on the device generates. A count that the method's memory does
        not show is taken to be as promised.
        """
        stats = self.scene.shown
        if not self.checked or not stats.F:
            return {"hit_ratio": None, "promised_ratio": None, "discarded_share": None}
        counted, promised = self.frame.probe(), Fitted(self.variant, stats).kept()
        shaded = counted.get("shaded_fragments")
        return {"hit_ratio": counted.get("stored_fragments", promised) / stats.F, "promised_ratio": promised / stats.F,
                "discarded_share": None if shaded is None else 1 - shaded / stats.F}


def verdict(variant: Variant, conformance: Mapping[str, float | int], lost: int,
            distinct_images: int = 1) -> tuple[str, str | None]:
    """Status and reason of a measured cell.

    An exact method is wrong above 1e-4, where it lost a fragment, or where its frames differ.
    """
    if not variant.guarantee.startswith("exact"):
        return "ok", None
    if lost:
        return "wrong", f"{lost} fragments lost"
    if conformance["max_abs_error"] > EXACT_ERROR:
        return "wrong", (f"max_abs_error {conformance['max_abs_error']:.3g} above {EXACT_ERROR:g}, "
                         f"{conformance['wrong_pixels']} wrong pixels")
    if distinct_images > 1:
        return "wrong", f"{distinct_images} different images of one scene"
    return "ok", None


def failure(error: Exception) -> tuple[str, str]:
    """Status and reason of a cell that raised: whatever a method or a driver does costs its own cell only."""
    if isinstance(error, CapacityError):
        return "overflow", str(error)
    if isinstance(error, MemoryError):
        return "out_of_memory", str(error) or "out of memory"
    return "crashed", " ".join((str(error) if isinstance(error, MfrError) else repr(error)).split())


def scene_values(fitted: Fitted) -> dict[str, Any]:
    """What is known of a cell without running it."""
    decision, stats = fitted.decision(), fitted.stats
    return {"fragments": stats.F, "covered_pixels": sum(stats.histogram[1:]),
            "max_fragments": len(stats.histogram) - 1, "memory_model_bytes": fitted.model_bytes(),
            "chosen_k": decision.k if decision else None}


def frames(variant: Variant, scene: SceneWork) -> list[dict[str, Any]]:
    """What a cell met and chose in each frame, where frames differ or the method chooses."""
    every = [Fitted(variant, stats) for stats in scene.frames]
    if len(every) == 1 and every[0].decision() is None:
        return []
    return [_frame_values(i, fitted) for i, fitted in enumerate(every)]


def _frame_values(index: int, fitted: Fitted) -> dict[str, Any]:
    choice, stats = fitted.decision(), fitted.stats
    return {"frame": index, "fragments": stats.F, "covered_pixels": sum(stats.histogram[1:]),
            "max_fragments": len(stats.histogram) - 1, "chosen_k": choice.k if choice else None,
            "kept": fitted.kept(), "histogram": list(stats.histogram)}
