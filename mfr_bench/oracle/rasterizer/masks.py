"""Which samples of a pixel a triangle covers, by a float64 rasterizer that shares nothing with any device."""

from __future__ import annotations

import numpy as np

BLUR_PX = 1 / 128  # distance from an edge, below which the fixed-point places of a device's corners may decide


def depth_inside(corners: np.ndarray, viewport: tuple[int, int], places: np.ndarray) -> np.ndarray:
    """float64 (n, H, W, samples): how far inside of all edges of a triangle a sample lies, in pixels; outside below 0.

    corners: (n, 3, 2), in pixels. places: (samples, 2), of the samples within a pixel, from its lower left. A triangle
    without area has no inside.
    """
    width, height = viewport
    x = np.arange(width)[:, None] + places[:, 0]  # (W, samples)
    y = (np.arange(height)[:, None] + places[:, 1])[:, None]  # (H, 1, samples)
    found = np.full((len(corners), height, width, len(places)), np.inf)
    for triangle, inside in zip(corners, found, strict=True):
        turn = np.sign(_cross(triangle[1] - triangle[0], triangle[2] - triangle[0]))
        for start, end in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
            (dx, dy), length = end - start, np.hypot(*(end - start))
            distance = dx * (y - start[1]) - dy * (x - start[0])
            np.minimum(inside, turn * distance / length if turn else -np.inf, out=inside)
    return found


def _cross(one: np.ndarray, other: np.ndarray) -> float:
    return float(one[0] * other[1] - one[1] * other[0])


def disagreements(masks: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """bool (n, H, W): where the masks of a device, int (n, H, W), differ from the samples that lie `inside`.

    Samples within BLUR_PX of an edge are not compared.
    """
    covered = (masks[..., None] >> np.arange(inside.shape[-1]) & 1) > 0
    return ((covered != (inside > 0)) & (np.abs(inside) > BLUR_PX)).any(axis=-1)
