"""The frames of a cell while it is measured: what they have taken and what they will take, by its own samples. Pure."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from statistics import median, stdev

from ..config.model import Measure
from ..stats import sampled_interval
from .forecast import IN_HAND, MEDIAN_WIDTH, WARMUP_FRAMES, FrameTime, most_s, parts_s, samples_wanted

INTERVAL = 6  # samples of which the median has an interval
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

    def _cv(self, foretold: float) -> float:
        low, middle, high = sampled_interval(self.samples_ms)
        if len(self.samples_ms) >= INTERVAL and None not in (low, high) and middle:
            return (high - low) / 2 / middle * math.sqrt(len(self.samples_ms)) / MEDIAN_WIDTH
        mean_ms = sum(self.samples_ms) / len(self.samples_ms)
        return max(foretold, stdev(self.samples_ms) / mean_ms) if len(self.samples_ms) > 2 and mean_ms else foretold

    def seconds(self, foretold: FrameTime, measure: Measure, done: bool = False) -> tuple[float, float]:
        """Seconds of frames that are over, and that are to come; of a cell that is done all are over."""
        frame = self.frame(foretold)
        sampling_s, others_s = parts_s(frame, measure)
        if done:
            return sum(self.samples_ms) / 1e3 + others_s, 0.0
        if not self.samples_ms:
            return 0.0, sampling_s + others_s
        frame_s = frame.time_ms / 1e3
        taken_s = sum(self.samples_ms) / 1e3 + WARMUP_FRAMES * frame_s
        wanted_s = (samples_wanted(frame, measure) - len(self.samples_ms)) * frame_s
        to_come_s = max(0.0, min(wanted_s, most_s(frame_s, measure) - taken_s))
        beside_s = BESIDE * others_s * taken_s / (taken_s + to_come_s)
        return taken_s + beside_s, to_come_s + others_s - beside_s
