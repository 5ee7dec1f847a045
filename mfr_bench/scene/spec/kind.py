"""The declaration of a kind of scene: its keys and their rules, what can be counted without making it, its words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Interval

from ...effects import COVERAGES, EFFECTS, MSAA, OPERATIONS, PLAIN, Settings
from .values import Allowed, Alpha, Colours, Listed, Seed, Share, Size, Text

SCENE = __package__.rpartition(".")[0]  # the package of the generators
MAX_PRIMITIVES = 2**22  # distinct depths on the grid of 2**-23, with a free point between any two
MAX_SHADING = 16384  # steps, well below the 65,535 iterations at which llvmpipe ends a loop silently
MAX_LAYER, MAX_ABSORPTION = 4096, 1000  # of effects
LATE = "late"  # metadata of a key that was added later
LOCAL = "local"  # metadata of a key that is no part of any record, and that no config may give

Fault = tuple[tuple[str, ...], str]  # the keys that decide it, and what is wrong


def late(default: Any) -> Any:
    """A key that older records lack: a record leaves it out while it has its default, so that those stay valid."""
    return field(default=default, metadata={LATE: True})


def local(default: Any) -> Any:
    """A key that only this machine knows, such as a path: it is set by the program and stands in no record."""
    return field(default=default, metadata={LOCAL: True})


@dataclass(frozen=True, kw_only=True)
class CommonKeys:
    """The keys that every kind of scene has.

    size: viewport, pixels. pixel_density: share of the pixels that the block or the tiles cover, or the block around
    an object. depth_complexity: fragments over every covered pixel, or the maximum over the pixels where the kind has
    a mean_depth (None: two fifths of the maximum); 0 where a kind measures it. alpha: lowest and highest opacity, or a
    word that a kind knows. shading: arithmetic steps of each fragment that is shaded, which change no colour.

    effect: what is done with the fragments of a pixel. layer: which of them `layers` shows, from the nearest; 0 for
    all. absorption: of light by `translucency`, along the whole depth range. operation: what `csg` makes of objects.

    msaa: samples of a pixel. coverage: what is made of the samples that fragments cover.
    """

    kind: str
    size: Size
    pixel_density: Share = 1.0
    depth_complexity: Annotated[int, Interval(ge=0, le=MAX_PRIMITIVES),
                                Allowed(f"a whole number from 0 to {MAX_PRIMITIVES}")]
    mean_depth: Annotated[float, Interval(ge=1, le=MAX_PRIMITIVES),
                          Allowed(f"a number from 1 to {MAX_PRIMITIVES}")] | None = None
    order: Literal["random", "front_to_back", "back_to_front", "file", "object"] = "random"
    alpha: Alpha | Literal["material"] = (0.1, 0.6)
    colours: Colours = "any"
    fragment_probability: Share = 1.0
    seed: Seed = 1
    animate: bool = False
    shading: Annotated[int, Interval(ge=0, le=MAX_SHADING),
                       Allowed(f"a whole number from 0 to {MAX_SHADING}")] = late(0)
    effect: Annotated[str, Listed(EFFECTS, "one of a package that is installed or given by --methods FOLDER")] = \
        late(PLAIN.name)
    layer: Annotated[int, Interval(ge=0, le=MAX_LAYER),
                     Allowed(f"a whole number from 0 to {MAX_LAYER}")] = late(PLAIN.layer)
    absorption: Annotated[float, Interval(gt=0, le=MAX_ABSORPTION),
                          Allowed(f"a number above 0, up to {MAX_ABSORPTION}")] = late(PLAIN.absorption)
    operation: Literal[OPERATIONS] = late(PLAIN.operation)
    msaa: Literal[MSAA] = late(PLAIN.msaa)
    coverage: Literal[tuple(COVERAGES)] = late(PLAIN.coverage)

    @property
    def settings(self) -> Settings:
        """The effect with the values that it reads."""
        return Settings(self.effect, **{key: getattr(self, key) for key in EFFECTS[self.effect].keys},
                        msaa=self.msaa, coverage=self.coverage)


@dataclass(frozen=True, kw_only=True)
class FileKeys:
    """The keys of kinds that read a file: its name, and the folder where a relative one is looked for."""

    file: Text | None = None
    folder: Text | None = local(None)

    @property
    def file_path(self) -> Path:
        """The path of the file, of a scene that has one."""
        return Path(self.folder or ".", self.file)


@dataclass(frozen=True, kw_only=True)
class NoKeys:
    """The keys of a kind that has none of its own."""


@dataclass(frozen=True)
class Described:
    """A row of the table in docs/scenes.md."""

    name: str  # as a config writes it, in Markdown
    what: str
    depth_complexity: str
    mean_depth: str
    stands_for: str


class Kind:
    """One kind of scene. A file of `scene/kinds/` declares it as KIND.

    Keys: a dataclass of the keys that only kinds which name it have. generator: the function that makes the scene, as
    module.function within `scene/`; it takes the scene's parameters and the number of the frame. rules: each takes
    the scene's parameters and gives a Fault or None. rows: the kind in docs/scenes.md; key_words: a Markdown list of
    its keys there.
    """

    name: ClassVar[str]
    Keys: ClassVar[type] = NoKeys
    generator: ClassVar[str]
    geometry: ClassVar[str] = "strip"  # shaders/scene/<geometry>.vert draws it
    noun: ClassVar[str] = "strips"  # what the primitives are called in an error message
    measured: ClassVar[bool] = False  # depth_complexity is what a device finds, and no key
    orders: ClassVar[Sequence[str]] = ("random", "front_to_back", "back_to_front")
    alphas: ClassVar[Sequence[str]] = ()  # words that `alpha` may be in place of numbers
    has_objects: ClassVar[bool] = False  # its primitives are faces of closed objects, or may be
    unused: ClassVar[Sequence[str]] = ()  # keys of every kind that this one has no use for
    fullest: ClassVar[float] = 1.0  # most mean depth, as a share of the depth complexity
    rules: ClassVar[Sequence[Callable[[Any], Fault | None]]] = ()
    rows: ClassVar[Sequence[Described]]
    key_words: ClassVar[str] = ""

    @property
    def module(self) -> ModuleType:
        """The module of the generator: it loads numpy, and is loaded when a scene needs it."""
        return import_module(f"{SCENE}.{self.generator.rpartition('.')[0]}")

    def covered_pixels(self, scene: CommonKeys) -> int:
        """Pixels with a fragment at least, where none is discarded; about, where the device decides."""
        raise NotImplementedError

    def primitives(self, scene: CommonKeys) -> int:
        """Primitives submitted; about, but never less than a third of them."""
        raise NotImplementedError

    def expected_counts(self, scene: CommonKeys) -> list[float]:
        """The covered pixels expected to have 0, 1, 2, … fragments."""
        raise NotImplementedError

    def geometry_of(self, scene: CommonKeys) -> str:
        """The geometry that the scene is drawn with."""
        return self.geometry

    def has_mean_depth(self, scene: CommonKeys) -> bool:
        """Whether depth_complexity is the maximum over the pixels, and mean_depth the mean over the covered ones."""
        return False

    def least_layers(self, scene: CommonKeys) -> int:
        """Fewest fragments that a covered pixel draws before any is discarded; 0 where every pixel draws all."""
        return 0

    def rejects(self, scene: CommonKeys) -> bool:
        """Whether some fragments of the primitives are not generated."""
        return scene.fragment_probability < 1 or self.least_layers(scene) > 0

    def where(self, scene: CommonKeys) -> str:
        """The kind in an error message."""
        return f"in kind {self.name}"

    def faults(self, scene: CommonKeys) -> list[Fault]:
        """The faults of values that are each allowed."""
        rules = (*self.rules, self._unknown_word, self._no_use, self._no_effect, self._no_samples)
        first = [fault for rule in rules if (fault := rule(scene))]
        if self.measured:
            return first  # nothing is counted before the scene is made
        found = (rule(scene) for rule in (self._too_many, self._no_mean, self._mean_too_high))
        return [*(fault for fault in found if fault), *first]

    def lacks(self, scene: CommonKeys) -> str | None:
        """The file or package that the scene needs and the machine lacks, with how to get it; None if there is none."""
        return None

    def package(self, scene: CommonKeys) -> Mapping[str, str | None] | None:
        """Name, version and hash of the package that makes the scene; None for this program's own kinds."""
        return None

    def record(self, scene: CommonKeys) -> dict[str, Any]:
        """The values that a record of the scene has in addition to its keys, or instead of them."""
        return {}

    def _unknown_word(self, scene: CommonKeys) -> Fault | None:
        for key, allowed in (("order", self.orders), ("alpha", self.alphas)):
            value = getattr(scene, key)
            if isinstance(value, str) and value not in allowed:
                what = f"{key} {value!r} has no use {self.where(scene)}; allowed: "
                return (f"scene.{key}", "scene.kind"), what + (" | ".join(allowed) or "one or two numbers from 0 to 1")
        return None

    def _no_use(self, scene: CommonKeys) -> Fault | None:
        defaults = {key.name: key.default for key in fields(CommonKeys)}
        changed = [key for key in self.unused if getattr(scene, key) != defaults[key]]
        if self.measured and scene.depth_complexity:
            changed.append("depth_complexity")
        if not changed:
            return None
        what = f"{changed[0]} has no use {self.where(scene)}; allowed: without it"
        return (f"scene.{changed[0]}", "scene.kind"), what

    def _no_effect(self, scene: CommonKeys) -> Fault | None:
        """The effect needs objects, or a key that only another effect reads has been given."""
        if EFFECTS[scene.effect].needs != "nothing" and not self.has_objects:
            what = f"effect {scene.effect} needs faces of closed objects; allowed: in kind mesh | fragments"
            return ("scene.effect", "scene.kind"), what
        every = {key: name for name, effect in EFFECTS.items() for key in effect.keys}
        unused = [key for key in every.keys() - set(EFFECTS[scene.effect].keys)
                  if getattr(scene, key) != getattr(PLAIN, key)]
        if not unused:
            return None
        readers = " | ".join(name for name, effect in EFFECTS.items() if unused[0] in effect.keys)
        what = f"{unused[0]} has no use with effect {scene.effect}; allowed: with effect {readers}"
        return (f"scene.{unused[0]}", "scene.effect"), what

    def _no_samples(self, scene: CommonKeys) -> Fault | None:
        """Nothing but blending is done in several samples, and one sample has nothing to resolve."""
        if scene.msaa > 1 and scene.effect != PLAIN.name:
            return ("scene.msaa", "scene.effect"), f"msaa {scene.msaa} with effect {scene.effect}; allowed: one of them"
        if scene.msaa == 1 and scene.coverage != PLAIN.coverage:
            what = f"coverage {scene.coverage} has no use with one sample a pixel; allowed: with msaa 2 | 4 | 8"
            return ("scene.coverage", "scene.msaa"), what
        return None

    def _too_many(self, scene: CommonKeys) -> Fault | None:
        count = self.primitives(scene)
        what = (f"{count} {self.noun} {self.where(scene)}; allowed: at most {MAX_PRIMITIVES}, "
                "so that depths stay distinct")
        return (("r", "scene.depth_complexity"), what) if count > MAX_PRIMITIVES else None

    def _no_mean(self, scene: CommonKeys) -> Fault | None:
        unused = scene.mean_depth is not None and not self.has_mean_depth(scene)
        what = (f"mean_depth has no use {self.where(scene)}; allowed: with layout mixed, or with a kind that has a "
                "mean depth of its own")
        return (("scene.mean_depth", "scene.layout"), what) if unused else None

    def _mean_too_high(self, scene: CommonKeys) -> Fault | None:
        if scene.mean_depth is None or not self.has_mean_depth(scene):
            return None
        most = max(1.0, self.fullest * scene.depth_complexity)
        what = (f"a mean_depth of {scene.mean_depth:g} under a maximum of {scene.depth_complexity}; "
                f"allowed in kind {scene.kind}: up to {most:g}")
        return (("scene.mean_depth", "r", "scene.depth_complexity"), what) if scene.mean_depth > most else None


def flat_geometry(scene: CommonKeys) -> str:
    """The geometry of pixel-aligned rectangles of one depth, which cover every sample of a pixel or none.

    They are rasterized into one sample: the two triangles of a rectangle would share the pixels of its diagonal.
    """
    return "masked" if scene.msaa > 1 else "quad"


def mean_depth(scene: CommonKeys) -> float:
    """Fragments per covered pixel that a scene with a mean depth aims at."""
    return scene.mean_depth or max(1.0, 0.4 * scene.depth_complexity)


class EstimatedKind(Kind):
    """A kind whose counts are estimated from the file that has its primitives."""

    def estimate(self, scene: CommonKeys) -> Any:
        """The expected numbers: `primitives`, `covered` pixels, and `counts` of pixels by their fragments."""
        raise NotImplementedError

    def primitives(self, scene: CommonKeys) -> int:
        return self.estimate(scene).primitives

    def covered_pixels(self, scene: CommonKeys) -> int:
        return self.estimate(scene).covered

    def expected_counts(self, scene: CommonKeys) -> list[float]:
        return list(self.estimate(scene).counts)
