"""Expects how many pixels have how many fragments, if chance decides: distributions without making a scene."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping
from itertools import pairwise

from .layout import shares


def even_counts(least: int, most: int, covered: int, probability: float) -> list[float]:
    """Pixels with 0, 1, … fragments, where each draws `least` to `most` evenly and keeps each with a probability."""
    share = covered / (most - least + 1)
    return thinned([(layers, share) for layers in range(least, most + 1)], most, probability)


def layered_counts(layers: int, mean: float, covered: int, probability: float) -> list[float]:
    """Pixels with 0, 1, … fragments, as if each layer covered a part of what the one before it covers."""
    ends = [*shares(layers, min(float(layers), mean)), 0.0]
    counts = [covered * (1.0 - ends[0])] + [covered * (share - after) for share, after in pairwise(ends)]
    return counts if probability == 1 else thinned(enumerate(counts), layers, probability)


def thinned(pixels_by_depth: Iterable[tuple[int, float]], most: int, probability: float) -> list[float]:
    """Pixels with 0, 1, …, `most` fragments, where each of a pixel's fragments is kept with the probability."""
    counts = [0.0] * (most + 1)
    for deep, pixels in pixels_by_depth:
        for hits, chance in binomial(deep, probability):
            counts[hits] += pixels * chance
    return counts


def placed_chances(length: int, quad: int, most: int = 16) -> list[float]:
    """Chance that a randomly placed quad covers the middle of each of `most` equal parts of the block's side."""
    parts = min(most, length)
    middles = [(2 * i + 1) * length // (2 * parts) for i in range(parts)]
    places = length - quad + 1
    return [(min(x, places - 1) - max(0, x - quad + 1) + 1) / places for x in middles]


def binomial_mix(trials: int, pixels_by_chance: Mapping[float, float]) -> list[float]:
    """Pixels expected to have 0, 1, … hits of `trials`, for pixels of each chance of a hit."""
    counts: dict[int, float] = defaultdict(float, {0: 0.0})
    for chance, pixels in pixels_by_chance.items():
        for hits, probability in binomial(trials, chance):
            counts[hits] += pixels * probability
    return [counts.get(hits, 0.0) for hits in range(max(counts) + 1)]


def binomial(trials: int, chance: float) -> list[tuple[int, float]]:
    """The binomial distribution within nine deviations of its mean."""
    if chance >= 1 or trials == 0:
        return [(trials, 1.0)]
    mean, reach = trials * chance, 9 * math.sqrt(trials * chance * (1 - chance)) + 9
    low, high = max(0, int(mean - reach)), min(trials, int(mean + reach))
    return [(i, math.exp(math.lgamma(trials + 1) - math.lgamma(i + 1) - math.lgamma(trials - i + 1)
                         + i * math.log(chance) + (trials - i) * math.log1p(-chance))) for i in range(low, high + 1)]
