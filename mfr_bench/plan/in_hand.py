"""The frames of a cell while it is measured: what they have taken and what they will take, by its own samples. Pure."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from statistics import median

from ..config.settings import Measure
from ..stats import sampled_interval
from .forecast import IN_HAND, MEDIAN_WIDTH, FrameTime, most_s, parts_s, samples_wanted, warmup_s

INTERVAL = 6  # samples of which the median has an interval
NORMAL = 1.4826  # deviations over median absolute ones of a normal distribution
FORETOLD = 6  # samples' worth of evidence that the foretold deviation is
BESIDE = 0.1  # of the frames that are no samples: those whose passes are timed between the batches


@dataclass
class InHand:
    """A cell's samples so far, in ms."""

    samples_ms: list[float] = field(default_factory=list)

    def frame(self, foretold: FrameTime) -> FrameTime:
        """The time of a frame, by the samples; as foretold without any."""
        if not self.samples_ms:
            return foretold
        return FrameTime(median(self.samples_ms), self._cv(foretold.cv), IN_HAND)

    @property
    def scatter(self) -> float | None:
        """The deviation of a frame by the interval of the median; None while there is none."""
        low, middle, high = sampled_interval(self.samples_ms) if len(self.samples_ms) >= INTERVAL else (None,) * 3
        if low is None or high is None or not middle:
            return None
        return (high - low) / 2 / middle * math.sqrt(len(self.samples_ms)) / MEDIAN_WIDTH

    def _cv(self, foretold: float) -> float:
        """The deviation by so many samples as there are, one stalled frame of which says nothing."""
        if (own := self.scatter) is not None:
            return own
        middle = median(self.samples_ms)
        if not middle:
            return foretold
        own = NORMAL * median(abs(ms - middle) for ms in self.samples_ms) / middle
        weight = len(self.samples_ms) / (len(self.samples_ms) + FORETOLD)
        return math.sqrt(weight * own**2 + (1 - weight) * foretold**2)

    def seconds(self, foretold: FrameTime, measure: Measure, done: bool = False) -> tuple[float, float]:
        """Seconds of frames that are over, and that are to come; of a cell that is done all are over."""
        frame = self.frame(foretold)
        sampling_s, others_s = parts_s(frame, measure)
        if done:
            return sum(self.samples_ms) / 1e3 + warmup_s(frame.time_ms / 1e3, measure) + others_s, 0.0
        if not self.samples_ms:
            return 0.0, sampling_s + others_s
        frame_s = frame.time_ms / 1e3
        taken_s = sum(self.samples_ms) / 1e3 + warmup_s(frame_s, measure)
        wanted_s = (samples_wanted(frame, measure) - len(self.samples_ms)) * frame_s
        to_come_s = max(0.0, min(wanted_s, most_s(frame_s, measure) - taken_s))
        beside_s = BESIDE * others_s * taken_s / (taken_s + to_come_s)
        return taken_s + beside_s, to_come_s + others_s - beside_s
