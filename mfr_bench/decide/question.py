"""The question of `mfr-bench decide`, parsed from the words of its options."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ..errors import UsageError
from ..scene.spec.values import MAX_SIDE
from ..store.status import EXACT_ERROR

DURATION = re.compile(r"(\d+(?:\.\d+)?)(s|m|h)")
SECONDS = {"s": 1.0, "m": 60.0, "h": 3600.0}


@dataclass(frozen=True)
class Question:
    """The scene in numbers, and the bounds that an answer keeps.

    size: pixels. layers: most fragments of a pixel. covered: share of the pixels with any. memory_mb: MiB, or None for
    any. max_error: largest error of a channel against the image of all fragments. estimated: whether layers and covered
    are guesses, which only a device can replace.
    """

    size: tuple[int, int]
    layers: int
    covered: float = 1.0
    memory_mb: float | None = None
    max_error: float = EXACT_ERROR
    estimated: bool = False

    @property
    def exact(self) -> bool:
        """Whether only exact images keep the error."""
        return self.max_error <= EXACT_ERROR

    def __str__(self) -> str:
        about = "about " * self.estimated
        parts = [f"{self.size[0]}×{self.size[1]} pixels", f"up to {about}{self.layers} layers",
                 f"{about}{100 * self.covered:.3g} % of the pixels covered",
                 "any memory" if self.memory_mb is None else f"at most {self.memory_mb:g} MiB",
                 "exact images" if self.exact else f"an error of at most {self.max_error:.4g}"]
        return ", ".join(parts)


def parsed_size(text: str) -> tuple[int, int]:
    """`1280x720` as (1280, 720). Raises UsageError."""
    match = re.fullmatch(r"(\d+)[x×](\d+)", text.strip())
    size = (int(match[1]), int(match[2])) if match else None
    if size is None or not all(1 <= side <= MAX_SIDE for side in size):
        raise UsageError(f"--size: {text!r} is no size; allowed: WIDTHxHEIGHT in pixels, each from 1 to {MAX_SIDE}, "
                         "such as 1280x720")
    return size


def parsed_error(text: str) -> float:
    """`1/255` or `0.004` as a number in [0, 1]. Raises UsageError."""
    try:
        over, _, under = text.partition("/")
        value = float(over) / (float(under) if under else 1.0)
    except (ValueError, ZeroDivisionError):
        value = -1.0
    if not 0 <= value <= 1:
        raise UsageError(f"--max-error: {text!r} is no error; allowed: a number from 0 to 1, or a fraction "
                         "such as 1/255")
    return value


def parsed_duration(text: str, option: str = "--time-budget") -> float:
    """`90s`, `2m` or `1.5h` in seconds. Raises UsageError."""
    match = DURATION.fullmatch(text.strip())
    seconds = float(match[1]) * SECONDS[match[2]] if match else 0.0
    if not 1 <= seconds <= 7 * 86400:
        raise UsageError(f"{option}: {text!r} is no duration; allowed: a number with s, m or h, from 1s to 168h, "
                         "such as 90s or 2m")
    return seconds
