"""`kind: strands`: hair, as polylines with a width in pixels, generated or from a file of one's own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from annotated_types import Interval

from ..spec.kind import CommonKeys, Described, EstimatedKind, Fault, FileKeys
from ..spec.values import Allowed
from .mesh import View, view_agrees

ENDINGS = (".npz", ".obj")
MAX_STRANDS, MAX_SEGMENTS = 2**18, 256
UNUSED = ("pixel_density", "mean_depth")


@dataclass(frozen=True, kw_only=True)
class StrandKeys(FileKeys):
    """The keys of strands.

    file: an .npz of points and lengths, or the lines of an OBJ; without one, `strands` hairs of `segments` pieces grow
    on a head. width: of a strand, pixels. thin: what becomes of strands thinner than a pixel. view: as of a mesh.
    """

    strands: Annotated[int, Interval(ge=1, le=MAX_STRANDS), Allowed(f"a whole number from 1 to {MAX_STRANDS}")] = 2000
    segments: Annotated[int, Interval(ge=1, le=MAX_SEGMENTS),
                        Allowed(f"a whole number from 1 to {MAX_SEGMENTS}")] = 16
    width: Annotated[float, Interval(gt=0, le=256), Allowed("pixels above 0, up to 256")] = 1.0
    thin: Literal["sliver", "alpha"] = "alpha"
    view: View = View()


def _file_is_there(scene: CommonKeys) -> Fault | None:
    if not scene.file:
        return None
    path = scene.file_path
    if path.suffix.lower() not in ENDINGS:
        return ("scene.file",), f"{scene.file} holds no strands; allowed: a file that ends in {' or '.join(ENDINGS)}"
    return None if path.is_file() else (("scene.file",), f"{path}: no such file; allowed: a file of strands")


def _no_count_of_a_file(scene: CommonKeys) -> Fault | None:
    defaults = StrandKeys()
    changed = [key for key in ("strands", "segments") if getattr(scene, key) != getattr(defaults, key)]
    if not (scene.file and changed):
        return None
    return (f"scene.{changed[0]}", "scene.file"), f"{changed[0]} beside a file, which has its own; allowed: one of them"


class Strands(EstimatedKind):
    """Hair."""

    name = "strands"
    noun = "pieces of strands"
    Keys = StrandKeys
    generator = "strands.hair"
    measured = True
    orders = ("random", "front_to_back", "back_to_front", "file")
    unused = UNUSED
    rules = (_file_is_there, _no_count_of_a_file, view_agrees)
    rows = (Described("`strands`", "hair: thousands of thin polylines", "measured", "measured", "hair and fur"),)
    key_words = """\
- `strands` hairs of `segments` pieces each grow on a head, curl and fall; or `file`: an .npz with `points`, float
  (n, 3), and `lengths`, int (m,), how many of the points each of m strands has; or an OBJ, of which each `l` is one.
- `width`, pixels, whatever the distance. Each piece is a strip that faces the eye, and shares its ends with its
  neighbours. `thin`: a strand below a pixel is drawn as thin as it is (`sliver`), so that it misses most pixels that it
  crosses; or one pixel wide with its alpha times its width (`alpha`).
- `view` as of a mesh. Pieces that reach behind the eye are left out. A strand has one colour. `order`: `file` strand by
  strand from its root, `random` piece by piece, or by the depth of the middle of a piece.
- `animate: true`: the camera goes around the up axis in eight frames.
"""

    def record(self, scene: CommonKeys) -> dict[str, Any]:
        if not scene.file:
            return {}
        return {"files": [scene.file_path.name], "digest": self.module.digest(scene)}

    def estimate(self, scene: CommonKeys):
        return self.module.estimate(scene)


KIND = Strands()
