"""Runs a variant's frame under many schedules, and judges what comes out."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain

import numpy as np

from ..errors import MfrError
from ..methods.spec import Fitted, Variant
from ..oracle import twochannel
from ..oracle.composite import stats_of
from ..oracle.quality import pixel_errors
from ..oracle.ties import Answer
from ..scene.quads import Quads
from .adapter import Frame, frame_of, locator
from .build import Built, build
from .promise import Kind, Promised, expected, promised

SAID = {
    "wrong_image": "the image is none that the fragments may give",
    "lost_fragments": "fragments were lost, and counted",
    "out_of_bounds_write": "an access beyond the end of a buffer that may write",
    "out_of_bounds_read": "a load beyond the end of a buffer",
    "local_array_overrun": "an index beyond the end of a local array",
    "stuck": "an invocation waits for a word that nobody will change",
    "endless": "an invocation does not come to an end",
    "barrier": "invocations wait at a barrier that others never reach",
    "grown": "more was asked for than the scene has",
}
ROUNDING = 1e-5  # of a channel: what float32 may make of the few fragments of a scene


@dataclass(frozen=True)
class How:
    """The choice of schedules, and the properties of the machine.

    warp: lanes of a warp in lockstep, 0 for none. late: branches with a return end where the shader does.
    bound: with `exhaustive`, deviations from running on. dependencies: a load is no older than the load that its
    address came from. in_flight: fragments of a pass that run at once, 0 for all.
    """

    schedules: int = 2000
    seed: int = 1
    weak: bool = False
    dependencies: bool = True
    warp: int = 0
    late: bool = False
    exhaustive: bool = False
    bound: int = 2
    ordered: bool = False
    helpers: bool = False
    count_all: bool = False
    in_flight: int = 0

    @property
    def words(self) -> list[str]:
        flags = {"weak": self.weak, "no-dependencies": not self.dependencies, "late": self.late,
                 "ordered": self.ordered, "all": self.count_all}
        return ["exhaustive" if self.exhaustive else "random", *(name for name, on in flags.items() if on),
                *(f"{name}={getattr(self, name)}" for name in ("schedules", "seed", "warp", "bound")),
                f"in-flight={self.in_flight}"]


class BrokenAloneError(MfrError):
    """The promise breaks already where the fragments come one after the other."""

    exit_status = 3


Deviation = tuple[int, int, int, int]


@dataclass(frozen=True)
class Event:
    """One access of a trace: `before` and `after` are the word's values, or what was read."""

    fiber: int
    site: int
    operation: str
    buffer: str
    word: int
    before: int
    after: int
    stale: bool


@dataclass(frozen=True)
class Failure:
    """A broken promise, the choices that lead to it, and what happened then."""

    what: str
    fiber: int
    site: int
    value: int
    lost: int
    image: np.ndarray  # float64 (H, W, 4)
    deviations: tuple[Deviation, ...]
    events: tuple[Event, ...]


@dataclass(frozen=True)
class Outcome:
    """The outcome of a run of schedules. `complete`: all schedules within the bound."""

    schedules: int
    seconds: float
    complete: bool
    failed: int
    wrong: int
    lost: int
    failure: Failure | None = field(default=None, repr=False)


class Checker:
    """One variant in one scene, built, with the images that it may give.

    like: a checker of the same variant in another scene, whose program serves here as well if the frames are equal.
    """

    def __init__(self, variant: Variant, scene: Quads, helpers: bool = False, like: Checker | None = None):
        self.variant, self.scene, self.helpers, self.like = variant, scene, helpers, like
        self.stats = stats_of(scene)
        self.frame: Frame = frame_of(Fitted(variant, self.stats), scene.bounds)

    @cached_property
    def built(self) -> Built:
        return self.like.built if self.like and self.like.frame == self.frame else build(self.frame)

    @cached_property
    def promised(self) -> Promised:
        return promised(self.variant, self.stats)

    @cached_property
    def images(self) -> np.ndarray:
        """float64 (count, H, W, 4): what the fragments give one after the other, in many orders.

        Raises BrokenAloneError where that breaks the promise already.
        """
        found = self._run(["reference"], images=())
        if found.get("failure"):
            raise BrokenAloneError(f"{self.variant.method.id}: {self.place(found['site'])}{SAID[found['failure']]}, "
                                   "without any race")
        width, height = self.scene.viewport
        images = np.array(found["images"], dtype=np.float64).reshape(-1, height, width, 4)
        self._compare(images)
        return images

    def _compare(self, images: np.ndarray) -> None:
        """Raise BrokenAloneError where the promise is exact and an image is not right by the oracle."""
        if self.promised.kind is not Kind.EXACT:
            return
        right = self._right
        error = max(float(pixel_errors(image, right).max(initial=0.0)) for image in images)
        if error > ROUNDING:
            raise BrokenAloneError(f"{self.variant.method.id}: its image has an error of {error:.3g}, without any race")

    @cached_property
    def _right(self) -> Answer:
        """The images that the variant aims at, with those that it may give where it loses equal depths by nature."""
        return expected(self.variant, self.stats, self.scene).given_by(self.variant.method)

    @property
    def _within(self) -> bool:
        """Whether images are held to a range, and not to those that some order of the fragments gives without a race.

        What a method loses of equal depths may depend on the schedule.
        """
        loses = self.variant.method.loses_ties and not self._right.unique
        return self.promised.kind is Kind.WITHIN or (self.promised.kind is Kind.EXACT and loses)

    def place(self, site: int) -> str:
        """File and line of an access, with what separates them from what follows; empty where it is none."""
        if site < 0:
            return ""
        number, line = self.built.sites[site]
        return f"{locator(self.frame.passes[number].own)(line)}: "

    def check(self, how: How) -> Outcome:
        """Runs the schedules until one breaks the promise."""
        found = self._run(how.words, self._allowed(), self._bounds())
        failure = _failure(found, self.scene.viewport)
        return Outcome(found["schedules"], found["seconds"], found["complete"], found["failed"], found["wrong"],
                       found["lost_frames"], failure)

    def replay(self, deviations: Sequence[Deviation], how: How) -> Failure:
        """One schedule again, by its choices."""
        words = ["replay", *(w for w in how.words[1:])]
        return _failure(self._run(words, self._allowed(), self._bounds(), deviations), self.scene.viewport)

    def picture(self, drawn: Quads, inside: Sequence[Sequence[int]], how: How) -> np.ndarray:
        """float64 (count, 4): the colours of pixels with these fragments of a scene, one schedule for each.

        The frame has one pixel, and room for the most fragments of any.
        """
        depths, codes = drawn.depth.view(np.uint32).tolist(), payloads(drawn, self.variant.two_channel)[1].tolist()
        rows = [[str(len(of)), *(f"0 0 {depths[i]} {codes[i]} {i} 0" for i in of)] for of in inside]
        lines = [*self._scene_lines(), *_image_lines(()), *_image_lines(()), str(len(rows)), *chain.from_iterable(rows)]
        colours = self._told(["picture", *how.words[1:]], lines)["colours"]
        if failed := [colour for colour in colours if isinstance(colour[0], str)]:
            raise MfrError(f"{self.variant.method.id}: {failed[0][0]} in {len(failed)} pixels, which have no colour")
        return np.array(colours, dtype=np.float64)

    def _allowed(self) -> np.ndarray:
        """The images that are right; none where they are held to a range."""
        return self.images[:0] if self._within else self.images

    @property
    def promises_nothing(self) -> bool:
        """Whether a wrong image breaks no promise."""
        return self.promised.kind is Kind.NONE

    def _bounds(self) -> np.ndarray:
        if not self._within:
            return self.images[:0]
        error = self.promised.error + ROUNDING
        return np.stack([self._right.low - error, self._right.high + error])

    def _run(self, words: list[str], images: Iterable[np.ndarray], bounds: Iterable[np.ndarray] = (),
             deviations: Sequence[Deviation] = ()) -> dict:
        lines = [*self._scene_lines(), *_image_lines(images), *_image_lines(bounds),
                 *(" ".join(map(str, d)) for d in deviations)]
        return self._told(words, lines)

    def _told(self, words: list[str], lines: Iterable[str]) -> dict:
        """The answer of the program."""
        may = ["may-lose"] if self.promised.counted else []
        command = [str(self.built.program), *words, *may, f"scene={self.scene.seed}"]
        done = subprocess.run(command, input="\n".join(lines) + "\n", capture_output=True, text=True, check=False,
                              env={**os.environ, "RACE_PARENT": str(os.getpid())})
        if done.returncode:
            raise MfrError(f"{self.variant.method.id}: the race machine ended with status {done.returncode}")
        return json.loads(done.stdout)

    def _scene_lines(self) -> list[str]:
        scene = self.scene
        base, codes = payloads(scene, self.variant.two_channel)
        rows = [f"{x} {y} {depth} {code} {quad} 0" for quad, ((x, y, *_), depth, code) in enumerate(
            zip(scene.rect.tolist(), scene.depth.view(np.uint32).tolist(), codes.tolist(), strict=True))]
        if self.helpers:
            rows += [f"{x} {y} {scene.depth.view(np.uint32)[0]} {codes[0]} {len(scene)} 1"
                     for x, y in sorted({(r[0], r[1]) for r in scene.rect.tolist()})]
        return [str(len(rows)), *rows, " ".join(f"{v:.9g}" for v in base)]


def payloads(scene: Quads, two_channel: bool) -> tuple[list[float], np.ndarray]:
    """The base colours, and the word of each fragment's payload."""
    if not two_channel:
        return [0.0] * 8, np.ascontiguousarray(scene.rgba).view("<u4")[:, 0]
    encoding, stored = twochannel.words(scene.rgba)
    return [*encoding.a, 0.0, *encoding.b, 0.0], np.ascontiguousarray(stored).view("<u4").reshape(-1)


def _image_lines(images: Iterable[np.ndarray]) -> list[str]:
    rows = [" ".join(f"{v:.9g}" for v in np.ravel(image)) for image in images]
    return [str(len(rows)), *rows]


def _failure(found: dict, viewport: tuple[int, int]) -> Failure | None:
    if not found.get("failure"):
        return None
    image = np.array(found["image"], dtype=np.float64).reshape(viewport[1], viewport[0], 4)
    return Failure(found["failure"], found["fiber"], found["site"], found["value"], found["lost"], image,
                   tuple(map(tuple, found["deviations"])), tuple(Event(*e) for e in found["events"]))
