"""The images that are right where fragments share a depth: the rule of docs/scenes.md, "Equal depths".

Which of two fragments of one depth is in front is nobody's to say. So the answer to a scene is a range for each
channel of each pixel: from the least to the greatest value that any order of equal depths gives. Of one pixel all
channels but opacity are the greatest where each run of equal depths shows its largest colour first, because
exchanging neighbours i and j changes the sum by a_i·a_j·(c_i − c_j); opacity does not depend on the order, but on
which fragments of a run have the last of the promised places.

A method that loses all but one fragment of a depth by nature has a wider range: every choice of one or more fragments
of each run, in any order. Against a background r, a fragment of colour c and alpha a shows r + a·(c - r), so the
greatest value takes all fragments whose colour exceeds the greatest of what lies behind, the largest in front; or, if
there are none, the one that shows least of itself. It is found run by run from the back.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..effects.rays import by_rank
from ..methods.spec import Method
from ..scene.quads import Quads
from .composite import Fragments, composite, in_chunks, over, taken
from .listed import listed

CHANNELS, ALPHA = range(4), 3
ANY = 1e9  # greater than every colour
TIED_BY_CHANCE = 0.01  # of the pixels: 0.0025 in the scenes of the papers
ROUNDING = 1e-9  # of float64: orders whose images are nearer than that are the same


@dataclass(frozen=True)
class Answer:
    """The right images of a scene: float64 (H, W, 4), premultiplied over transparent black, row 0 at the bottom.

    image: equal depths in order of submission. low, high: the least and the greatest value that any order gives.
    losing: the answer for a method that loses all but one fragment of a depth; None if it is this one.
    """

    image: np.ndarray
    low: np.ndarray
    high: np.ndarray
    losing: Answer | None = None

    @classmethod
    def only(cls, image: np.ndarray) -> Answer:
        """The answer that one image alone is."""
        return cls(image, image, image)

    @property
    def unique(self) -> bool:
        """Whether one image alone is right."""
        return self.low is self.high

    @property
    def bytes(self) -> int:
        """The memory of the images that are kept, each counted once."""
        arrays = {id(a): a.nbytes for a in (self.image, self.low, self.high)}
        return sum(arrays.values()) + (self.losing.bytes if self.losing else 0)

    @cached_property
    def tied(self) -> np.ndarray:
        """bool (H, W): pixels in which fragments of one depth and different colours leave the image open."""
        if self.unique:
            return np.zeros(self.image.shape[:2], dtype=bool)
        return (self.high - self.low > ROUNDING).any(axis=-1)

    def nearest(self, image: np.ndarray) -> np.ndarray:
        """The right values that are nearest to those of an image, float64 (H, W, 4)."""
        return self.image if self.unique else np.clip(image, self.low, self.high)

    def given_by(self, method: Method) -> Answer:
        """The images that a method may give, with what equal depths cost it by nature."""
        if self.losing is None or not method.loses_ties:
            return self
        return self.losing.open if method.spoils_ties else self.losing

    @cached_property
    def open(self) -> Answer:
        """The answer that leaves its tied pixels open altogether."""
        low, high = (np.where(self.tied[..., None], bound, self.image) for bound in (-ANY, ANY))
        return Answer(self.image, low, high)

    @property
    def tied_by_chance(self) -> bool:
        """Whether so few of the pixels that show anything are tied that no scene was made for it."""
        return np.count_nonzero(self.tied) <= TIED_BY_CHANCE * np.count_nonzero(self.high[..., ALPHA])


def answer_of_quads(scene: Quads, layers: int | None = None, criterion: str = "nearest",
                    payload: np.ndarray | None = None) -> Answer:
    """The answer to a scene of flat quads, as `composite` takes its arguments."""
    if _shares_depths(scene):
        return answer_of_fragments(listed(scene), layers, criterion, payload)
    return Answer.only(composite(scene, layers, criterion, payload))


def _shares_depths(scene: Quads) -> bool:
    """Whether two quads of different colours have one depth."""
    looks = np.unique(np.concatenate([scene.depth[:, None] + 0.0, scene.rgba], axis=1), axis=0)[:, 0]
    return len(np.unique(looks)) < len(looks)


def answer_of_fragments(fragments: Fragments, layers: int | None = None, criterion: str = "nearest",
                        payload: np.ndarray | None = None) -> Answer:
    """The answer to a scene whose fragments are known one by one."""
    payload = fragments.scene.rgba / 255.0 if payload is None else payload
    image = fragments.composite(layers, criterion, payload)
    pixels = np.flatnonzero(fragments.coincident)
    if not len(pixels):
        return Answer.only(image)
    ends = [image.copy().reshape(-1, 4) for _ in range(4)]
    every = _Runs.of(fragments, pixels)
    for part, among in in_chunks(every.counts):
        runs = every.part(part, among)
        found = (*runs.bounds(payload, layers, criterion), *runs.losing_bounds(payload, layers, criterion))
        for end, values in zip(ends, found, strict=True):
            end[pixels[part]] = values
    low, high, lowest, highest = (end.reshape(image.shape) for end in ends)
    return Answer(image, low, high, Answer(image, lowest, highest))


@dataclass(frozen=True)
class _Runs:
    """The fragments of some pixels, nearest first, in runs of one depth.

    counts: int64 (pixels,). primitive: uint32 (F,). run: int64 (F,), the number of each fragment's run, ascending.
    alpha: uint8 (F,).
    """

    counts: np.ndarray
    primitive: np.ndarray
    run: np.ndarray
    alpha: np.ndarray

    @classmethod
    def of(cls, fragments: Fragments, pixels: np.ndarray) -> _Runs:
        every = fragments.counts.ravel()
        counts, begins = every[pixels], (np.cumsum(every) - every)[pixels]
        first = np.cumsum(counts) - counts
        where = np.repeat(begins - first, counts) + np.arange(int(counts.sum()))
        depth, primitive = fragments.depth[where], fragments.primitive[where]
        new = np.ones(len(depth), dtype=bool)
        new[1:] = depth[1:] != depth[:-1]
        new[first] = True
        return cls(counts, primitive, np.cumsum(new), fragments.scene.rgba[primitive, ALPHA])

    def part(self, pixels: slice, among: slice) -> _Runs:
        """The runs of a range of pixels, whose fragments are `among`."""
        return _Runs(self.counts[pixels], self.primitive[among], self.run[among], self.alpha[among])

    def bounds(self, payload: np.ndarray, layers: int | None, criterion: str) -> tuple[np.ndarray, np.ndarray]:
        """float64 (pixels, 4): the least and the greatest of each channel.

        Of a pixel in which fragments of one run compete for the last places, opacity alone is bounded.
        """
        low, high = (np.stack([self._extreme(channel, sign, payload, layers, criterion) for channel in CHANNELS], -1)
                     for sign in (1, -1))
        if layers is not None:
            competing = self._competing(payload, layers, criterion)
            low[competing, :ALPHA], high[competing, :ALPHA] = 0.0, ANY
        return low, high

    def _extreme(self, channel: int, sign: int, payload: np.ndarray, layers: int | None,
                 criterion: str) -> np.ndarray:
        """The channel's least (sign 1) or greatest (-1) value in each pixel."""
        if channel == ALPHA and criterion == "furthest":
            sign = -sign  # places are taken from the far end
        order = np.lexsort((sign * payload[self.primitive, channel], self.run))
        counts, primitive = self.counts, self.primitive[order]
        if layers is not None:
            primitive = primitive[taken(counts, self.alpha[order], layers, criterion)]
            counts = np.minimum(counts, layers)
        return over(payload, primitive, counts)[:, channel]

    def _competing(self, payload: np.ndarray, layers: int, criterion: str) -> np.ndarray:
        """bool (pixels,): where a run of different colours has some of its fragments among the promised, not all."""
        among = taken(self.counts, self.alpha, layers, criterion)
        starts = np.flatnonzero(np.diff(self.run, prepend=self.run[0] - 1))
        sizes = np.diff(starts, append=len(self.run))
        some = np.add.reduceat(among.astype(np.int64), starts)
        colour = payload[self.primitive]
        differs = (np.maximum.reduceat(colour, starts) > np.minimum.reduceat(colour, starts)).any(axis=-1)
        pixel = np.repeat(np.arange(len(self.counts)), self.counts)[starts]
        found = np.zeros(len(self.counts), dtype=bool)
        found[pixel[(some > 0) & (some < sizes) & differs]] = True
        return found

    def losing_bounds(self, payload: np.ndarray, layers: int | None, criterion: str) -> tuple[np.ndarray, np.ndarray]:
        """float64 (pixels, 4): the ends of each channel where all but one fragment of a run may be lost.

        Of `layers` places those of lost fragments may go to what follows: runs that hold a promised fragment show at
        least one of theirs, the others, up to so many depths in all, may. Any fragment of a run may be the one.
        """
        among, shown = self._depths_among(layers, criterion)
        runs = _Runs(np.add.reduceat(among.astype(np.int64), self._starts_of_pixels), self.primitive[among],
                     self.run[among], self.alpha[among])
        low, high = (np.stack([runs._losing_extreme(channel, sign, payload, shown[among]) for channel in CHANNELS], -1)
                     for sign in (1, -1))
        return low, high

    @property
    def _starts_of_pixels(self) -> np.ndarray:
        return np.cumsum(self.counts) - self.counts

    def _depths_among(self, layers: int | None, criterion: str) -> tuple[np.ndarray, np.ndarray]:
        """bool (F,), two: of the runs that may show, those that must, by fragment."""
        every = np.ones(len(self.run), dtype=bool)
        if layers is None:
            return every, every
        starts = np.flatnonzero(np.diff(self.run, prepend=self.run[0] - 1))
        of = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(self.run)))
        must = np.logical_or.reduceat(taken(self.counts, self.alpha, layers, criterion), starts)[of]
        first = np.repeat(of[self._starts_of_pixels], self.counts)
        last = np.repeat(of[self._starts_of_pixels + self.counts - 1], self.counts)
        rank = {"nearest": of - first, "furthest": last - of}.get(criterion)
        return (every if rank is None else rank < layers) | must, must

    def _losing_extreme(self, channel: int, sign: int, payload: np.ndarray, shown: np.ndarray) -> np.ndarray:
        """The channel's least (sign 1) or greatest (-1) value in each pixel. shown: bool (F,), runs that must show."""
        colour = np.ones(len(payload)) if channel == ALPHA else payload[:, channel]
        order = np.lexsort((sign * colour[self.primitive], self.run))
        colour, alpha = -sign * colour[self.primitive[order]], payload[self.primitive[order], ALPHA]
        pixels, ranks = by_rank(self.counts)
        behind = np.zeros(self.counts.size)  # the greatest of the runs that are done
        with_run, alone, run = behind.copy(), np.full(self.counts.size, -np.inf), np.full(self.counts.size, -1)
        for at in reversed(list(ranks)):
            here = slice(len(at))
            new = self.run[at] != run[here]
            behind[here] = np.where(new, _with_one(behind[here], with_run[here], alone[here]), behind[here])
            with_run[here] = np.where(new, behind[here], with_run[here])
            least = np.where(shown[at], -np.inf, behind[here])  # a run that need not show may show nothing
            alone[here] = np.where(new, least, alone[here])
            run[here] = self.run[at]
            alone[here] = np.maximum(alone[here], behind[here] + alpha[at] * (colour[at] - behind[here]))
            with_run[here] += alpha[at] * np.maximum(0.0, colour[at] - with_run[here])
        found = np.empty(self.counts.size)
        found[pixels] = -sign * _with_one(behind, with_run, alone)
        return found


def _with_one(behind: np.ndarray, with_run: np.ndarray, alone: np.ndarray) -> np.ndarray:
    """The greatest value with a run: with the fragments that raise it, or else with the one that lowers it least."""
    return np.where((with_run > behind) | (alone == -np.inf), with_run, alone)
