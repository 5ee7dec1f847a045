"""Effects: what is done with the fragments of a pixel once they are in order, nearest first.

An effect is an entry of EFFECTS, a file of shaders/effects/ with begin, add and end, and a module here of the same name
whose `model` computes the same in float64. A package from outside has its entry as EFFECT in the module of its model.
Importing this package loads no numpy.

In multisampled scenes `coverage` takes the place of an effect: it does something with the samples of a pixel.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Literal

from ..errors import UsageError, nearest
from .numbers import DEFINES


@dataclass(frozen=True)
class Case:
    """A pixel whose image is known without a model: `mfr-bench check` compares the model with it.

    fragments: nearest first, each (window depth, (red, green, blue, opacity) from 0 to 255), and for an effect that
    needs more than `nothing` also the number of its object, and whether its front is seen. shows: red, green, blue and
    opacity from 0 to 1, premultiplied. keys: those of the scene that the effect reads, by name.
    """

    fragments: tuple[tuple[Any, ...], ...]
    shows: tuple[float, float, float, float]
    keys: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Effect:
    """An effect. needs: what it reads of a fragment in addition to depth and colour. ordered: whether it distinguishes
    fragments of one depth by their order. measures: whether it takes differences of depth as distances.

    cases: pixels whose image is known; those of an effect of this program are in its tests.

    package: name, version and hash of what brings the effect from outside, and place, its module or its folder, from
    which the process that measures imports the model. The loader of packages fills in both.
    """

    what: str
    needs: Literal["nothing", "facing", "objects"] = "nothing"
    ordered: bool = False
    measures: bool = False
    keys: tuple[str, ...] = ()  # of a scene, which this effect reads
    cases: tuple[Case, ...] = ()
    package: Mapping[str, str | None] | None = None
    place: str = ""


TRANSPARENCY = "transparency"
OPERATIONS = ("union", "intersection", "difference")
EFFECTS: dict[str, Effect] = {
    TRANSPARENCY: Effect("fragments blended nearest first, as the papers measure", ordered=True),
    "layers": Effect("the `layer`-th fragment alone, opaque; with layer 0 an x-ray view, in which every fragment takes "
                     "a tenth of the light", ordered=True, keys=("layer",)),
    "thickness": Effect("how much of a ray lies within at least one closed object, in window depth", "facing",
                        measures=True),
    "translucency": Effect("white light from behind, after what closed objects absorb of it by the length within them",
                           "facing", measures=True, keys=("absorption",)),
    "collision": Effect("where the insides of two closed objects overlap, along what length, in how many intervals",
                        "objects", ordered=True, measures=True),
    "csg": Effect("the surface of the union, the intersection or the difference of the first object and the others",
                  "objects", ordered=True, keys=("operation",)),
    "coplanar": Effect("where fragments share a depth: their share of the pixel's fragments, and the largest group"),
}
OWN_EFFECTS = tuple(EFFECTS)  # of this program; `bring` adds those from outside
MSAA = (1, 2, 4, 8)  # samples of a pixel
COVERAGES: Mapping[str, str] = {
    "samples": "each sample composites the fragments that cover it, and a pixel is the mean of its samples",
    "alpha": "a fragment's opacity is multiplied by the share of the samples that it covers",
    "ignored": "a fragment counts as if it covered its whole pixel",
}
COVERAGE = "coverage"  # the module and the GLSL file that resolve the samples of a pixel


@dataclass(frozen=True)
class Settings:
    """An effect by name, and the values of the keys that effects read.

    msaa: samples of a pixel. coverage: a key of COVERAGES, what is made of the samples that fragments cover.
    """

    name: str = TRANSPARENCY
    layer: int = 1
    absorption: float = 4.0
    operation: str = OPERATIONS[0]
    msaa: int = MSAA[0]
    coverage: str = next(iter(COVERAGES))

    @classmethod
    def of(cls, scene: Mapping[str, Any]) -> Settings:
        """Read the settings in the record of a scene, which leaves defaults out."""
        return cls(scene.get("effect", cls.name), **{f.name: scene[f.name] for f in fields(cls)[1:] if f.name in scene})

    @property
    def defines(self) -> dict[str, int | float]:
        """The values, and the numbers of all effects, by the names that they have in GLSL."""
        return {**DEFINES, "EFFECT_LAYER": self.layer, "EFFECT_ABSORPTION": self.absorption,
                "EFFECT_OPERATION": OPERATIONS.index(self.operation), "MSAA": self.msaa,
                **{f"COVERAGE_{name}".upper(): int(name == self.coverage) for name in COVERAGES}}

    @property
    def keys(self) -> dict[str, Any]:
        """The keys of a config that make a scene have this effect, where they differ from their defaults."""
        read = (*self.effect.keys, "msaa", "coverage")
        found = {"effect": self.name} | {key: getattr(self, key) for key in read}
        return {f"scene.{key}": value for key, value in found.items() if value != DEFAULTS[key]}

    @property
    def blended(self) -> bool:
        """Whether the fragments of a pixel of one sample are blended, and nothing else is done with them."""
        return self.name == TRANSPARENCY and self.msaa == 1

    @property
    def module(self) -> str:
        """The name of the module here with the model, and of the GLSL file."""
        return COVERAGE if self.msaa > 1 else self.name

    @property
    def effect(self) -> Effect:
        """The entry of the effect. Raises UsageError where the package that brings it is not given."""
        if self.name not in EFFECTS:
            raise UsageError(f"scene.effect: no effect {self.name!r}; allowed: {', '.join(EFFECTS)}, or one of a "
                             f"package that is installed or given by --methods FOLDER{nearest(self.name, EFFECTS)}")
        return EFFECTS[self.name]


def bring(found: Mapping[str, Effect]) -> None:
    """Let EFFECTS have these effects from outside, and no others from outside."""
    for name in set(EFFECTS).difference(OWN_EFFECTS):
        del EFFECTS[name]
    EFFECTS.update(found)


PLAIN = Settings()
DEFAULTS = {"effect": TRANSPARENCY} | {f.name: f.default for f in fields(Settings)[1:]}
