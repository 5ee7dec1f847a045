"""The arms of a spiral, with some fragments in each of their pixels."""

from __future__ import annotations

import numpy as np

from mfr_bench.methods.spec.maker import Maker, Number

SCENE = Maker("arms of a spiral, half of the viewport", keys={"arms": Number(3, 1, 64), "layers": Number(8, 1, 256),
                                                              "turns": Number(2.0, 0.0, 16.0)})


def fragments(size: tuple[int, int], seed: int, arms: int, layers: int, turns: float) -> dict[str, np.ndarray]:
    """Arrays of docs/recording.md: one to `layers` fragments in every pixel of an arm, at depths of their own."""
    width, height = size
    random = np.random.default_rng(seed)
    y, x = np.mgrid[:height, :width]
    right, up = (x + 0.5) / width - 0.5, (y + 0.5) / height - 0.5
    on_arm = (arms * np.arctan2(up, right) / (2 * np.pi) + turns * np.hypot(right, up)) % 1 < 0.5
    counts = random.integers(1, layers + 1, on_arm.sum())
    pixel = random.permutation(np.repeat(np.stack([x[on_arm], y[on_arm]], axis=1), counts, axis=0))
    depth = (random.permutation(len(pixel)) + 0.5) / max(len(pixel), 1)
    rgba = random.integers((0, 0, 0, 26), (256, 256, 256, 154), (len(pixel), 4))
    return {"pixel": pixel.astype(np.int32), "depth": depth.astype(np.float32), "rgba": rgba.astype(np.uint8)}
