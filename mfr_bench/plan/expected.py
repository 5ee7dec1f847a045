"""The statistics that a scene should have, found without making it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import accumulate, pairwise

from ..methods.spec import SceneStats
from ..scene import Scene
from ..scene.kinds import kind_of


@lru_cache(maxsize=512)
def expected_stats(scene: Scene) -> SceneStats:
    """The scene's statistics: exact for layouts block and tiles without rejected fragments.

    They are about right elsewhere: the fragments of slanted primitives are known when a device has drawn them.
    """
    kind = kind_of(scene)
    covered = kind.covered_pixels(scene)
    counts = _whole_pixels(kind.expected_counts(scene), covered)
    histogram = (counts[0] + scene.size[0] * scene.size[1] - covered, *counts[1:])
    fragments = sum(f * pixels for f, pixels in enumerate(histogram))
    return SceneStats(
        *scene.size, n=max(1, len(histogram) - 1), F=fragments, primitives=kind.primitives(scene), histogram=histogram,
        rejects=kind.rejects(scene), geometry=kind.geometry_of(scene), least=kind.least_layers(scene),
        shading=scene.shading, effect=scene.settings)


def _whole_pixels(counts: Sequence[float], total: int) -> list[int]:
    """The counts in whole pixels that add up to `total`, without zeros at the end."""
    ends = [min(total, round(end)) for end in accumulate(counts)]
    ends[-1] = total
    whole = [end - start for start, end in pairwise([0, *ends])]
    while len(whole) > 1 and not whole[-1]:
        whole.pop()
    return whole
