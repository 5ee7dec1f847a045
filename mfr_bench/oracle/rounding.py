"""Shows what compositing loses to rounding, without any device: a pixel's layers in the arithmetic of choice.

The device's own resolves round the same way (shaders/common/accumulate.glsl); docs/accuracy.md has the bounds.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..markdown import markdown_table

Rounding = Callable[[np.ndarray], np.ndarray]


def _unorm8(x: np.ndarray) -> np.ndarray:
    return (np.rint(np.float32(255) * x) / np.float32(255)).astype(np.float32)


# The rounding of the colour after each layer; every step in between is in float32.
ROUNDINGS: dict[str, Rounding] = {
    "float32": lambda x: x,
    "float16": lambda x: x.astype(np.float16).astype(np.float32),
    "unorm8": _unorm8,
}


def payloads(rgba: np.ndarray) -> np.ndarray:
    """float32 (n, …, 4), premultiplied as the shaders do it, of uint8 straight RGBA, nearest first."""
    straight = rgba.astype(np.float32) / np.float32(255)
    return np.concatenate([straight[..., :3] * straight[..., 3:], straight[..., 3:]], axis=-1)


def by_transmittance(layers: np.ndarray) -> np.ndarray:
    """Front to back, with the product of 1 - alpha in place of 1 minus the opacity: what exact methods do."""
    colour, through = np.zeros_like(layers[0][..., :3]), np.ones_like(layers[0][..., 3:])
    for layer in layers:
        colour, through = colour + through * layer[..., :3], through * (np.float32(1) - layer[..., 3:])
    return np.concatenate([colour, np.float32(1) - through], axis=-1)


def under(layers: np.ndarray, rounding: str = "float32") -> np.ndarray:
    """Front to back: what lies behind shows through what is there."""
    rounded, colour = ROUNDINGS[rounding], np.zeros_like(layers[0])
    for layer in layers:
        colour = rounded(colour + (np.float32(1) - colour[..., 3:]) * layer)
    return colour


def over(layers: np.ndarray, rounding: str = "float32") -> np.ndarray:
    """Back to front: each layer covers what lies behind it."""
    rounded, colour = ROUNDINGS[rounding], np.zeros_like(layers[0])
    for layer in layers[::-1]:
        colour = rounded(layer + (np.float32(1) - layer[..., 3:]) * colour)
    return colour


def compensated(layers: np.ndarray) -> np.ndarray:
    """The layers composited by transmittance, with what each addition rounds away carried along (Kahan 1965)."""
    colour, through = np.zeros_like(layers[0][..., :3]), np.ones_like(layers[0][..., 3:])
    excess = np.zeros_like(colour)
    for layer in layers:
        added = through * layer[..., :3] - excess
        total = colour + added
        excess = (total - colour) - added
        colour, through = total, through * (np.float32(1) - layer[..., 3:])
    return np.concatenate([colour, np.float32(1) - through], axis=-1)


def exact(rgba: np.ndarray) -> np.ndarray:
    """float64: the reference."""
    straight = rgba / 255.0
    colour = np.zeros(rgba.shape[1:])
    for layer in np.concatenate([straight[..., :3] * straight[..., 3:], straight[..., 3:]], axis=-1):
        colour = colour + (1 - colour[..., 3:]) * layer
    return colour


WAYS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "by transmittance, float32": by_transmittance,
    "the same, compensated": compensated,
    "under, float32": under,
    "over, float32": over,
    "under, float16": lambda layers: under(layers, "float16"),
    "over, float16": lambda layers: over(layers, "float16"),
    "under, 8 bits": lambda layers: under(layers, "unorm8"),
    "over, 8 bits": lambda layers: over(layers, "unorm8"),
}


def errors(layers: int, alpha: tuple[int, int], pixels: int = 64, seed: int = 1) -> dict[str, float]:
    """Largest channel error of each of WAYS over random pixels; `alpha` in 255ths, both ends included."""
    random = np.random.default_rng(seed)
    rgba = random.integers(0, 256, (layers, pixels, 4), dtype=np.uint8)
    rgba[..., 3] = random.integers(alpha[0], alpha[1] + 1, (layers, pixels))
    stored, truth = payloads(rgba), exact(rgba)
    return {name: float(np.abs(way(stored) - truth).max()) for name, way in WAYS.items()}


def as_markdown(counts: tuple[int, ...] = (16, 128, 1024, 4096),
                alphas: tuple[tuple[int, int], ...] = ((1, 1), (8, 8), (26, 153))) -> str:
    """The table of docs/accuracy.md: a row per way, a column per opacity and number of layers."""
    columns = [(alpha, n) for alpha in alphas for n in counts]
    found = [errors(n, alpha) for alpha, n in columns]
    heads = [f"{low}–{high}, n = {n}" if low != high else f"{low}, n = {n}" for (low, high), n in columns]
    rows = ((name, *(f"{each[name]:.1e}" for each in found)) for name in WAYS)
    return "\n".join(markdown_table(("alpha · 255", *heads), rows, left=1)) + "\n"
