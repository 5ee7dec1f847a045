"""`kind: fragments`: fragments that were recorded before, in one's own renderer or from any scene."""

from __future__ import annotations

from typing import Any

from ...errors import UsageError
from ..spec.kind import CommonKeys, Described, Fault, FileKeys, Kind, flat_geometry

UNUSED = ("pixel_density", "mean_depth", "colours", "alpha", "fragment_probability", "animate")


def _has_a_file(scene: CommonKeys) -> Fault | None:
    what = "no file; allowed: file, an .npz as mfr-bench scene --fragments writes it"
    return None if scene.file else (("scene.file", "scene.kind"), what)


def _file_agrees(scene: CommonKeys) -> Fault | None:
    """The file can be read, and its viewport is the scene's."""
    if not scene.file:
        return None
    try:
        viewport = KIND.module.viewport_of(scene.file_path)
    except UsageError as error:
        return ("scene.file",), str(error)
    what = f"{list(scene.size)} where {scene.file} has {list(viewport)} pixels; allowed: the viewport of the file"
    return None if viewport == tuple(scene.size) else (("scene.size", "scene.file"), what)


def _has_masks(scene: CommonKeys) -> Fault | None:
    """The file has coverage masks if pixels have several samples."""
    if scene.msaa == 1 or not scene.file or _file_agrees(scene):
        return None
    found = KIND.module.has_masks(scene.file_path)
    return None if found else (("scene.msaa", "scene.file"), f"{scene.file} has {KIND.module.NO_MASKS}")


class Fragments(Kind):
    """Recorded fragments."""

    name = "fragments"
    noun = "fragments"
    Keys = FileKeys
    generator = "recording.fragments"
    measured = True
    has_objects = True
    orders = ("random", "front_to_back", "back_to_front", "file")
    unused = UNUSED
    rules = (_has_a_file, _file_agrees, _has_masks)
    rows = (Described("`fragments`", "fragments recorded elsewhere, each a quad of one pixel", "measured", "measured",
                      "what one renders"),)
    key_words = """\
- `file`: an .npz of recorded fragments, relative to the config; [recording.md](recording.md) says what it holds and how
  to make one. `size` is the viewport of the file.
- `order`: `file` as recorded, `random`, or by depth either way.
- Depths, colours and opacities are those of the file. Of fragments that share a depth any order is right ([Equal
  depths](#equal-depths)); `tied_pixels` counts their pixels.
- `msaa` above 1 takes the coverage masks of the file ([msaa.md](msaa.md)); on any device, since nothing is rasterized
  into samples. With `msaa: 1` a fragment covers its pixel, whatever its mask.
"""

    def geometry_of(self, scene: CommonKeys) -> str:
        return flat_geometry(scene)

    def primitives(self, scene: CommonKeys) -> int:
        return sum(count * pixels for count, pixels in enumerate(self.expected_counts(scene)))

    def covered_pixels(self, scene: CommonKeys) -> int:
        return max(1, sum(self.expected_counts(scene)))

    def expected_counts(self, scene: CommonKeys) -> list[int]:
        return self.module.covered_counts(scene.file_path)

    def record(self, scene: CommonKeys) -> dict[str, Any]:
        return {"files": [scene.file_path.name], "digest": self.module.digest(scene.file_path)}


KIND = Fragments()
