"""`kind: outside`: fragments that a package or folder of one's own makes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...errors import UsageError
from ...methods.outside import scene_makers
from ..spec.kind import CommonKeys, Described, Fault
from ..spec.values import Text
from .fragments import UNUSED, Fragments


@dataclass(frozen=True, kw_only=True)
class OutsideKeys:
    """The keys of scenes from outside: the name of what makes them, and what it is told."""

    maker: Text | None = None
    options: Text | None = None


def _is_given(scene: CommonKeys) -> Fault | None:
    """The scene's package is given, and makes its fragments."""
    makers = scene_makers()
    if scene.maker not in makers:
        what = (f"no scene {scene.maker!r}; allowed: {' | '.join(makers) or 'none now'}, or one of a package that is "
                "installed or given by --methods FOLDER")
        return ("scene.maker", "scene.kind"), what
    try:
        makers[scene.maker].values(scene.options)
    except ValueError as error:
        return ("scene.options", "scene.maker"), str(error)
    try:
        KIND.module.path_of(scene)
    except UsageError as error:
        return ("scene.maker",), str(error)
    return None


def _has_masks(scene: CommonKeys) -> Fault | None:
    """The fragments have coverage masks if pixels have several samples."""
    from .. import recording

    if scene.msaa == 1 or _is_given(scene) or recording.has_masks(KIND.module.path_of(scene)):
        return None
    return ("scene.msaa", "scene.maker"), f"{scene.maker} has {recording.NO_MASKS}"


class Outside(Fragments):
    """Fragments that a package from outside makes."""

    name = "outside"
    Keys = OutsideKeys
    generator = "made.fragments"
    unused = UNUSED
    rules = (_is_given, _has_masks)
    rows = (Described("`outside`", "fragments that a package of one's own makes", "measured", "measured",
                      "what a function gives"),)
    key_words = """\
- `maker`: the name of a scene of a package that is installed, or of a folder that `--methods` gives;
  [own-scenes.md](own-scenes.md) says how to write one.
- `options`: its own keys as text, such as `arms=5 spread=0.3`.
- All else is as in `kind: fragments`; `size` and `seed` are handed to the package.
"""

    def package(self, scene: CommonKeys):
        return scene_makers()[scene.maker].package

    def expected_counts(self, scene: CommonKeys) -> list[int]:
        from .. import recording

        return recording.covered_counts(self.module.path_of(scene))

    def record(self, scene: CommonKeys) -> dict[str, Any]:
        from .. import recording

        return {"digest": recording.digest(self.module.path_of(scene))}


KIND = Outside()
