"""The loop over cells: prepare, check against the oracle, sample interleaved, store each row as it is done."""

from __future__ import annotations

import hashlib
import random
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import groupby
from typing import Any

import numpy as np

from . import quality
from .errors import MfrError, StoreError
from .glsl import stages
from .gpu.device import Device
from .gpu.frame import Canvas, Frame, SceneBuffer
from .gpu.timers import Timer
from .gpu.truth import Truth, true_sizes
from .measure.sampling import Sampler
from .measure.split import Split
from .methods.spec import Method, Promise, Sizes, Variant
from .plan import Cell, expected_sizes, judge
from .scene import Geometry, generate
from .stats import interleaved_ratio
from .store import ResultFolder, key

ANIMATION_FRAMES = 8  # that an animated scene cycles through
LIVE_BYTES = 4 * 2**30  # of methods that are interleaved; more are measured in turns
PASS_FRAMES = 7
PASS_SHARE = 0.25  # of the time limit, at most, spent on frames whose passes are timed
ALL = Promise()  # every fragment: the A-buffer's image
NOMINAL = Sizes(W=1, H=1, n=2, F=1, quads=1)  # the scene is in a cell's key of its own

Report = Callable[[dict[str, Any]], None]
Sampled = Callable[[float], None]


@dataclass(frozen=True)
class Job:
    """A cell with its key: what to measure, and under which name it is kept."""

    cell: Cell
    variant: Variant
    key: str
    glsl_hash: str


def glsl_hash(variant: Variant, geometry: str) -> str:
    """Hash of every stage of every pass, at sizes that stand for those of any scene of this geometry."""
    digest = hashlib.sha256()
    for step in variant.passes:
        for stage in stages(variant, step, replace(NOMINAL, geometry=geometry)) if step.kind != "clear" else ():
            digest.update(stage.text.encode())
    return digest.hexdigest()[:16]


def jobs(cells: Sequence[Cell], catalog: Mapping[str, Method], device: Mapping[str, str], timer: str) -> list[Job]:
    """The cells with their keys, which cover the method with its GLSL and parameters, scene, settings and device."""
    variants = [catalog[cell.method].variant(cell.params) for cell in cells]
    shaders = [(v, expected_sizes(c.scene).geometry) for v, c in zip(variants, cells, strict=True)]
    codes = {key: glsl_hash(*key) for key in set(shaders)}
    found = []
    for cell, (variant, geometry) in zip(cells, shaders, strict=True):
        code = codes[variant, geometry]
        name = key({"method": cell.method, "label": cell.label, "params": dict(cell.params), "glsl": code,
                    "scene": cell.scene.as_dict(), "measure": cell.measure.as_dict(),
                    "renderer": device["renderer"], "version": device["version"], "timer": timer})
        found.append(Job(cell, variant, name, code))
    return found


class SceneWork:
    """One scene on the device, with its oracle images, for all cells that share it."""

    def __init__(self, device: Device, config, split: Split):
        self.split = split
        self._device, self._oracles, self._qualities, self._truths = device, {}, {}, {}
        with split.work("scene"):
            frames = ANIMATION_FRAMES if config.animate else 1
            self.scenes = [generate(config, frame) for frame in range(frames)]
            self._sizes = {id(self.show(i)): true_sizes(device, self.quads, self.canvas) for i in range(frames)}
            self.sizes = _largest(list(self._sizes.values()))

    @cached_property
    def quads(self) -> SceneBuffer:
        return SceneBuffer(self._device, self.scenes[0])

    @cached_property
    def canvas(self) -> Canvas:
        return Canvas(self._device, self.scenes[0].viewport)

    @property
    def frames(self) -> list[Sizes]:
        """Of every frame of an animation."""
        return list(self._sizes.values())

    @property
    def shown(self) -> Sizes:
        """Of the scene on the device now."""
        return self._sizes[id(self.quads.scene)]

    def show(self, frame: int) -> Geometry:
        """Bring the scene of an animation's frame to the device."""
        scene = self.scenes[frame % len(self.scenes)]
        if scene is not self.quads.scene:
            self.quads.replace(scene)
        return scene

    @property
    def truth(self) -> Truth:
        """The oracle of the scene on the device now."""
        scene = self.quads.scene
        return self._truths.setdefault(id(scene), Truth(self._device, self.quads, self.canvas))

    def conformance(self, variant: Variant, image: np.ndarray) -> dict[str, float | int]:
        """Errors of an image of the scene on the device against what the variant aims at."""
        return quality.conformance(image, self.promised(variant), self.truth.tied)

    def promised(self, variant: Variant) -> np.ndarray:
        """The float64 image that the variant aims at in the scene on the device now."""
        return self.oracle(variant.promise(self.shown))

    def oracle(self, promise: Promise) -> np.ndarray:
        """The float64 image of the promised fragments of the scene on the device now; computed once."""
        if promise.layers is not None and promise.layers >= self.sizes.n:
            promise = ALL
        which = id(self.quads.scene), promise
        if which not in self._oracles:
            with self.split.work("oracle"):
                self._oracles[which] = self.truth.image(promise)
        return self._oracles[which]

    def untied(self, image: np.ndarray) -> np.ndarray:
        """The image without the pixels in which the order of fragments is nobody's to say."""
        tied = self.truth.tied
        return image if tied is None else np.where(tied[..., None], np.float32(0), image)

    def quality(self, image: np.ndarray) -> dict[str, float | None]:
        """Errors against all fragments; equal images, as exact methods give them, are compared once."""
        which = id(self.quads.scene), hashlib.sha256(image).digest()
        if which not in self._qualities:
            self._qualities[which] = quality.quality(image, self.oracle(ALL))
        return self._qualities[which]

    def release(self) -> None:
        for name in ("quads", "canvas"):
            if name in self.__dict__:
                self.__dict__[name].release()


def _largest(sizes: list[Sizes]) -> Sizes:
    """Room for every frame of an animation."""
    biggest = max(sizes, key=lambda s: s.F)
    return replace(biggest, n=max(s.n for s in sizes), quads=max(s.quads for s in sizes))


@dataclass
class Running:
    """A cell that passed its first check and is being sampled."""

    job: Job
    frame: Frame
    sampler: Sampler
    conformance: dict[str, float | int]
    quality: dict[str, float | None]
    lost: int
    twin: Sampler | None = None  # the same again, for the noise floor
    passes: dict[str, list[float]] = field(default_factory=dict)
    passes_s: float = 0.0  # spent on timing passes
    done: bool = False  # its row is written

    @property
    def samplers(self) -> list[Sampler]:
        return [s for s in (self.sampler, self.twin) if s]

    @property
    def wanted(self) -> bool:
        return not self.done and any(s.wanted for s in self.samplers)

    @property
    def share(self) -> float:
        """How much of the most frames or time that it may take has been taken."""
        return 0.0 if self.done else min(s.share for s in self.samplers)


@dataclass
class Summary:
    """How a run ended: cells by status, rows kept from before, the noise floor."""

    statuses: dict[str, int] = field(default_factory=dict)
    kept: int = 0
    noise_floor_rel: float | None = None


class Runner:
    """Measures jobs into a result folder.

    `report` receives each row as it is written, `sampled` how many cells' worth of the rows to come is done.
    Once `interrupted` says so, `run` raises KeyboardInterrupt between two frames, with what can be kept written.
    """

    def __init__(self, device: Device, timer: Timer, folder: ResultFolder, catalog: Mapping[str, Method],
                 report: Report = lambda row: None, sampled: Sampled = lambda cells: None,
                 split: Split | None = None, interrupted: Callable[[], bool] = lambda: False):
        self.device, self.timer, self.folder, self.catalog = device, timer, folder, catalog
        self.report, self.sampled, self.split = report, sampled, split or Split()
        self.interrupted = interrupted
        self.summary = Summary()
        self._shuffle = random.Random(0).shuffle  # noqa: S311 - an order, not a secret

    def run(self, todo: Sequence[Job], force: bool = False) -> Summary:
        """Measure every job that the folder lacks, or all with `force`, scene by scene."""
        for _, group in groupby(todo, key=lambda job: job.cell.scene):
            missing = [job for job in group if force or not self._kept(job)]
            if missing:
                self._run_scene(missing)
        return self.summary

    def _kept(self, job: Job) -> bool:
        """Whether the folder has the job's row; its place in this experiment is brought up to date."""
        row = self.folder.cell(job.key)
        if row is None:
            return False
        place = self._place(job)
        if any(row.get(name) != value for name, value in place.items()):
            row |= place
            self.folder.write_cell(row)
        self.summary.kept += 1
        self._count(row)
        return True

    def _run_scene(self, missing: list[Job]) -> None:
        try:
            work = SceneWork(self.device, missing[0].cell.scene, self.split)
        except MemoryError as error:
            for job in missing:
                self._write(job, *failure(error), values={})
            return
        try:
            allowed = [job for job in missing if not self._skipped(job, work.sizes)]
            for chunk in _chunks(allowed, work.sizes):
                self._run_chunk(chunk, work)
        finally:
            work.release()

    def _skipped(self, job: Job, sizes: Sizes) -> bool:
        """Decide without compiling or allocating anything whether the device or the budget forbids the cell."""
        decision = judge(job.cell, self.catalog, sizes, self.device.limits)
        if decision:
            self._write(job, *decision, values=_scene_values(job, sizes))
        return decision is not None

    def _run_chunk(self, chunk: list[Job], work: SceneWork) -> None:
        running = [r for r in (self._prepare(job, work) for job in chunk) if r]
        try:
            self._sample(running, work)
        except KeyboardInterrupt:
            for r in running:
                if r.sampler.interrupt():
                    self._guarded(r, work, self._finish)
            raise
        finally:
            for r in running:
                r.frame.release()

    def _stop_if_asked(self) -> None:
        if self.interrupted():
            raise KeyboardInterrupt

    def _prepare(self, job: Job, work: SceneWork) -> Running | None:
        """Compile, allocate, draw once and check the image; a cell that fails ends as its row."""
        self._stop_if_asked()
        frame = None
        try:
            work.show(0)
            with self.split.work("compile"):
                frame = Frame(self.device, job.variant, work.sizes, work.quads, work.canvas)
                frame.draw_fitting()
                self.device.finish()
                self.device.check(f"{job.cell.method}: first frame")
            with self.split.work("check"):
                return self._checked(job, frame, work)
        except StoreError:
            raise
        except Exception as error:  # noqa: BLE001 - whatever it is, it is this cell's result
            self._write(job, *failure(error), values=_scene_values(job, work.sizes))
        if frame:
            frame.release()
        return None

    def _checked(self, job: Job, frame: Frame, work: SceneWork) -> Running:
        image = frame.image()
        compared = job.variant.method.guarantee != "none"
        conformance = work.conformance(job.variant, image) if compared else {}
        against_all = work.quality(image) if compared else {}
        return Running(job, frame, Sampler(job.cell.measure), conformance, against_all, frame.lost_fragments())

    def _sample(self, running: list[Running], work: SceneWork) -> None:
        """Feed all samplers in rounds of random order, so that drift hits all alike; finish each as it is done."""
        self._plant_twin(running)
        entries = [(r, s) for r in running for s in r.samplers]
        while entries:
            self._shuffle(entries)
            for r, sampler in entries:
                self._guarded(r, work, partial(self._batch, sampler=sampler))
            for r in running:
                if not r.wanted:
                    self._guarded(r, work, self._finish)
            self.sampled(sum(r.share for r in running))
            entries = [(r, s) for r, s in entries if s.wanted and not r.done]

    def _guarded(self, running: Running, work: SceneWork, step: Callable[[Running, SceneWork], None]) -> None:
        """Run a step of a cell that is not done; what goes wrong in it costs that cell alone."""
        if running.done:
            return
        try:
            step(running, work)
        except StoreError:
            raise
        except Exception as error:  # noqa: BLE001 - whatever it is, it is this cell's result
            running.done = True
            self._write(running.job, *failure(error), values=_scene_values(running.job, work.sizes))

    def _plant_twin(self, running: list[Running]) -> None:
        """One cell a run is sampled twice: the difference is the noise floor."""
        methods = [r for r in running if r.conformance]
        if self.summary.noise_floor_rel is None and methods:
            methods[0].twin = Sampler(methods[0].job.cell.measure)

    def _batch(self, running: Running, work: SceneWork, sampler: Sampler) -> None:
        for _ in sampler.turn():
            self._stop_if_asked()
            scene = work.show(len(sampler.samples_ms))
            running.frame.show(scene)
            with self.split.work("measure" if sampler.warm else "warm-up"):
                time_ms = self.timer.frame_ms(running.frame.draw)
            sampler.add(time_ms)
        if sampler.warm:
            self._time_passes(running, work, frames=1)

    def _finish(self, running: Running, work: SceneWork) -> None:
        """Time the passes, check the image once more, write the row."""
        job, sampler = running.job, running.sampler
        self._time_passes(running, work, PASS_FRAMES)
        with self.split.work("check"):
            self._check_again(running, work)
            distinct = self._distinct_images(running, work)
        if running.twin:
            measure = job.cell.measure
            low, _, high = interleaved_ratio(running.twin.samples_ms, sampler.samples_ms, measure.min_samples,
                                             measure.max_samples)
            if low is not None and high is not None:
                self.summary.noise_floor_rel = max(abs(low - 1), abs(high - 1))
        status, reason = verdict(job.variant, running.conformance, running.lost, distinct or 1)
        low, middle, high = sampler.interval
        values = _scene_values(job, work.sizes) | running.conformance | running.quality | {
            "samples": len(sampler.samples_ms), "timer": self.timer.name, "time_ms": middle, "time_ms_low": low,
            "time_ms_high": high, "noisy": sampler.noisy, "stop_reason": sampler.stop_reason,
            "memory_bytes": sum(running.frame.memory_bytes.values()),
            "lost_fragments": running.lost, "geometry_passes": running.frame.geometry_passes,
            "distinct_images": distinct, **_shares(running, work.shown),
        }
        self._write(job, status, reason, values=values, warmup_ms=sampler.warmup_ms, samples_ms=sampler.samples_ms,
                    passes=running.passes, buffers=running.frame.memory_bytes, frames=_frames(job, work))
        running.done = True

    def _time_passes(self, running: Running, work: SceneWork, frames: int) -> None:
        """Time the passes in frames of their own, between the batches, so that drift hits both alike."""
        limit_s = PASS_SHARE * running.job.cell.measure.time_limit_s
        done = len(next(iter(running.passes.values()), ()))
        with self.split.work("passes"):
            for _ in range(min(frames, PASS_FRAMES - done)):
                if running.passes_s > limit_s:
                    break
                running.frame.show(work.show(len(running.sampler.samples_ms)))
                times = self.timer.passes_ms(running.frame.draw)
                running.passes_s += sum(times.values()) / 1e3
                for name, time_ms in times.items():
                    running.passes.setdefault(name, []).append(time_ms)

    def _check_again(self, running: Running, work: SceneWork) -> None:
        """The last image must be as right as the first: the worse of the two counts."""
        running.frame.show(work.show(0))
        running.frame.draw()
        running.lost += running.frame.lost_fragments()
        self.device.check(f"{running.job.cell.method}: sampling")
        if running.conformance:
            again = work.conformance(running.job.variant, running.frame.image())
            running.conformance = {name: max(value, again[name]) for name, value in running.conformance.items()}

    def _distinct_images(self, running: Running, work: SceneWork) -> int | None:
        """Different images of the scene on the device, where more than one frame is asked for and images compare."""
        wanted = running.job.cell.measure.repeat_images
        if wanted == 1 or not running.conformance:
            return None
        images = set()
        for _ in range(wanted):
            self._stop_if_asked()
            running.frame.draw()
            images.add(hashlib.sha256(work.untied(running.frame.image())).digest())
        running.lost += running.frame.lost_fragments()
        return len(images)

    def _place(self, job: Job) -> dict[str, Any]:
        """Where the row stands in this experiment; not part of its key."""
        return {"experiment": job.cell.experiment, "point": _json(job.cell.point)}

    def _write(self, job: Job, status: str, reason: str | None, values: Mapping[str, Any], **more: Any) -> None:
        info = self.device.info
        row = self._place(job) | {
            "key": job.key, "method": job.cell.method, "label": job.cell.label, "params": dict(job.cell.params),
            "scene": job.cell.scene.as_dict(), "measure": job.cell.measure.as_dict(), "status": status,
            "reason": reason, "values": dict(values), "glsl_hash": job.glsl_hash,
            "device": {name: info[name] for name in ("slug", "renderer", "version")},
            "measured": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()), **more,
        }
        with self.split.work("store"):
            self.folder.write_cell(row)
        self._count(row)
        self.report(row)

    def _count(self, row: Mapping[str, Any]) -> None:
        self.summary.statuses[row["status"]] = self.summary.statuses.get(row["status"], 0) + 1


def verdict(variant: Variant, conformance: Mapping[str, float | int], lost: int,
            distinct_images: int = 1) -> tuple[str, str | None]:
    """Status and reason of a measured cell.

    An exact method is wrong above 1e-4, where it lost a fragment, or where its frames differ.
    """
    if not variant.guarantee.startswith("exact"):
        return "ok", None
    if lost:
        return "wrong", f"{lost} fragments lost"
    if conformance["max_abs_error"] > quality.EXACT_ERROR:
        return "wrong", (f"max_abs_error {conformance['max_abs_error']:.3g} above {quality.EXACT_ERROR:g}, "
                         f"{conformance['wrong_pixels']} wrong pixels")
    if distinct_images > 1:
        return "wrong", f"{distinct_images} different images of one scene"
    return "ok", None


def failure(error: Exception) -> tuple[str, str]:
    """Status and reason of a cell that raised: whatever a method or a driver does costs its own cell only."""
    if isinstance(error, MemoryError):
        return "out_of_memory", str(error) or "out of memory"
    return "crashed", " ".join((str(error) if isinstance(error, MfrError) else repr(error)).split())


def _chunks(todo: list[Job], sizes: Sizes) -> Iterator[list[Job]]:
    """Jobs in order, as many together as fit the memory for interleaving."""
    chunk: list[Job] = []
    held = 0
    for job in todo:
        needed = sum(job.variant.memory_bytes(sizes).values())
        if chunk and held + needed > LIVE_BYTES:
            yield chunk
            chunk, held = [], 0
        chunk.append(job)
        held += needed
    if chunk:
        yield chunk


def _scene_values(job: Job, sizes: Sizes) -> dict[str, Any]:
    """What is known of a cell without running it."""
    decision = job.variant.decision(sizes)
    return {"fragments": sizes.F, "covered_pixels": sum(sizes.histogram[1:]),
            "max_fragments": len(sizes.histogram) - 1, "memory_model_bytes": job.variant.model_bytes(sizes),
            "chosen_k": decision.k if decision else None}


def _frames(job: Job, work: SceneWork) -> list[dict[str, Any]]:
    """What the cell met and chose in each frame, where frames differ or the method chooses."""
    chosen = [job.variant.decision(sizes) for sizes in work.frames]
    if len(chosen) == 1 and chosen[0] is None:
        return []
    return [{"frame": i, "fragments": sizes.F, "covered_pixels": sum(sizes.histogram[1:]),
             "max_fragments": len(sizes.histogram) - 1, "chosen_k": choice.k if choice else None,
             "kept": job.variant.kept(sizes), "histogram": list(sizes.histogram)}
            for i, (sizes, choice) in enumerate(zip(work.frames, chosen, strict=True))]


def _shares(running: Running, sizes: Sizes) -> dict[str, float | None]:
    """Of the fragments generated: those kept, those that the promise keeps, and those discarded before the store.

    `sizes` are of the scene on the device. What the method's memory cannot be asked for is as promised.
    """
    variant = running.job.variant
    if variant.method.guarantee == "none" or not sizes.F:
        return {"hit_ratio": None, "promised_ratio": None, "discarded_share": None}
    counted, promised = running.frame.probe(), variant.kept(sizes)
    arrived = counted.get("arrived_fragments")
    return {"hit_ratio": counted.get("held_fragments", promised) / sizes.F, "promised_ratio": promised / sizes.F,
            "discarded_share": None if arrived is None else 1 - arrived / sizes.F}


def _json(value: Any) -> Any:
    """Tuples as the lists that JSON gives back."""
    if isinstance(value, Mapping):
        return {name: _json(item) for name, item in value.items()}
    return [_json(item) for item in value] if isinstance(value, (list, tuple)) else value
