"""Colours in two channels of 8 bits: luminance, and a blend of two base colours (gpupro5_ch2, Kluczek 2014).

Light is the square of what 8 bits hold (gamma 2, §2.2.1). The plane through black that lies nearest to a scene's
colours cuts the RGB cube in an angle; its two sides, where they leave the cube, are the base colours. A colour keeps
its luminance, and of its hue the blend of the base colours nearest to it in the plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # §2.2.3
IMPORTANCE = np.array([0.5, 1.0, 0.25])  # of red, green and blue when the plane is fitted (§2.2.1)
# The silhouette of the unit cube as seen from black: red, yellow, green, cyan, blue, magenta.
SILHOUETTE = np.array([[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1], [1, 0, 1]], dtype=np.float64)
NEAR = 1e-9  # of a unit normal's distance to a corner of the cube that counts as none


def light(rgb: np.ndarray) -> np.ndarray:
    """float64 (n, 3) in [0, 1] of uint8 (n, 3)."""
    return np.square(rgb / 255.0)


@dataclass(frozen=True)
class Encoding:
    """The base colours, as light: float64 (3,) that float32 holds, so that a device has the same."""

    a: np.ndarray
    b: np.ndarray

    @classmethod
    def fit(cls, rgb: np.ndarray) -> Encoding:
        """Fit to colours uint8 (n, 3) the plane through black of least squared distance (§2.2.1-2.2.2)."""
        weighted = light(rgb) * IMPORTANCE
        normal = np.linalg.eigh(weighted.T @ weighted)[1][:, 0] * IMPORTANCE
        return cls(*np.float32(_base_colours(normal / np.linalg.norm(normal))).astype(np.float64))

    @cached_property
    def _axes(self) -> np.ndarray:
        """float64 (2, 3): the plane's own coordinates, x along a (§2.2.4)."""
        x = self.a / np.linalg.norm(self.a)
        y = self.b - (x @ self.b) * x
        return np.stack([x, y / max(np.linalg.norm(y), NEAR)])

    def encode(self, rgb: np.ndarray) -> np.ndarray:
        """uint8 (n, 2): the square root of the luminance, and the blend, of uint8 (n, 3)."""
        linear = light(rgb)
        root = np.sqrt(linear @ LUMINANCE)
        return np.rint(255.0 * np.stack([root, self._blend(linear)], axis=-1)).astype(np.uint8)

    def _blend(self, linear: np.ndarray) -> np.ndarray:
        """The share of the way from a to b at which the ray through a colour crosses it; the nearer end for others."""
        (ax, ay), (bx, by), (x, y) = self._axes @ self.a, self._axes @ self.b, self._axes @ linear.T
        from_a, to_b = ax * y - ay * x, x * by - y * bx
        inside = (from_a > 0) & (to_b > 0)
        return np.where(inside, from_a / np.where(inside, from_a + to_b, 1.0), (from_a > 0) & (to_b <= 0))

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """float64 (n, 3), the square root of light, of uint8 (n, 2); above 1 where a hue is too dark for its luminance.

        Listing 2.1, and back to gamma 2.
        """
        root, blend = codes[:, :1] / 255.0, codes[:, 1:] / 255.0
        colour = self.a * (1.0 - blend) + self.b * blend
        return root * np.sqrt(colour / (colour @ LUMINANCE)[:, None])


def _base_colours(normal: np.ndarray) -> np.ndarray:
    """float64 (2, 3): where a plane through black leaves the cube; of an edge or a face in it the outer corners."""
    side = SILHOUETTE @ normal
    side[np.abs(side) < NEAR] = 0.0
    found = []
    for i in range(len(side)):
        j = (i + 1) % len(side)
        if side[i] * side[j] < 0:
            found.append((side[j] * SILHOUETTE[i] - side[i] * SILHOUETTE[j]) / (side[j] - side[i]))
        elif side[i] == 0 and (side[j] != 0 or side[i - 1] != 0):
            found.append(SILHOUETTE[i])
    return np.stack([found[0], found[-1]])


def straight(rgba: np.ndarray) -> np.ndarray:
    """float64 (n, 4): colours uint8 (n, 4) as they come back from an encoding fitted to them; alpha is kept."""
    encoding = Encoding.fit(rgba[:, :3])
    return np.concatenate([encoding.decode(encoding.encode(rgba[:, :3])), rgba[:, 3:] / 255.0], axis=-1)


def words(rgba: np.ndarray) -> tuple[Encoding, np.ndarray]:
    """The encoding fitted to colours uint8 (n, 4), and what is stored of each: luminance, blend, 0, alpha.

    That is 24 bits of a word of 32.
    """
    encoding = Encoding.fit(rgba[:, :3])
    stored = np.zeros_like(rgba)
    stored[:, :2], stored[:, 3] = encoding.encode(rgba[:, :3]), rgba[:, 3]
    return encoding, stored


def errors(rgba: np.ndarray) -> dict[str, float]:
    """The colours uint8 (n, 4) as the encoding gives them back.

    luminance_error: the largest error of a luminance in [0, 1]. hue_error: the mean angle between a colour's light
    and that which comes back, degrees; colours without light have none.
    """
    before, after = light(rgba[:, :3]), np.square(straight(rgba)[:, :3])
    return {"luminance_error": float(np.abs((after - before) @ LUMINANCE).max(initial=0.0)),
            "hue_error": angle(before, after)}


def angle(before: np.ndarray, after: np.ndarray) -> float:
    """The mean angle between the light (n, 3) of colours before and after, degrees; black has none."""
    lengths = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    seen = lengths > 0
    cosine = np.sum(before * after, axis=1)[seen] / lengths[seen]
    return float(np.degrees(np.arccos(np.clip(cosine, -1, 1))).mean()) if seen.any() else 0.0
