"""Small scenes that differ in what can go wrong, and frames drawn of them."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

from ..config import Scene as SceneConfig
from ..gpu.frame import Frame
from ..gpu.single import Shown
from ..methods.spec import Fitted, SceneStats, Variant
from ..oracle.quality import conformance
from ..scene import generate
from ..scene.geometry import Geometry
from ..scene.kinds import kind_of
from .variants import label

N = 7  # most scenes have as many fragments at most in a pixel, so that their programs are shared too
TWO_CLASSES = 9  # layers of which backwards memory allocation makes two classes of pixels

SCENES = {
    "flat": SceneConfig(size=(32, 24), depth_complexity=1),
    "empty": SceneConfig(size=(32, 24), depth_complexity=0),
    "one pixel": SceneConfig(size=(1, 1), depth_complexity=N),
    "sorted": SceneConfig(size=(97, 71), depth_complexity=N, order="front_to_back", pixel_density=0.93),
    "reverse-sorted": SceneConfig(size=(97, 71), depth_complexity=N, order="back_to_front", pixel_density=0.93),
    "sparse": SceneConfig(size=(97, 71), depth_complexity=N, pixel_density=0.11, seed=3),
    "tiles": SceneConfig(size=(97, 71), depth_complexity=N, pixel_density=0.4, layout="tiles", seed=4),
    "rejecting": SceneConfig(size=(97, 71), depth_complexity=N, fragment_probability=0.25, seed=4),
    "uneven": SceneConfig(size=(97, 71), depth_complexity=N, least_depth=0.3, fragment_probability=0.8, seed=5),
    "scattered": SceneConfig(size=(64, 48), depth_complexity=2, layout="random", quad_size=(11, 7), seed=7),
    "opaque": SceneConfig(size=(40, 40), depth_complexity=N, alpha=(1.0, 1.0), seed=7),
}
# 128 fragments at most in a pixel of every layout, 44 in the mean of the last.
DEPTHS = {"block": {"depth_complexity": 128}, "tiles": {"depth_complexity": 128},
          "random": {"depth_complexity": 44, "quad_size": (9, 5)}}
DEEP = {f"{layout} {order}": SceneConfig(size=(31, 13), layout=layout, order=order, seed=3, pixel_density=0.6,
                                         **DEPTHS[layout])
        for layout in ("block", "tiles", "random") for order in ("random", "front_to_back", "back_to_front")}
SLANTED = {
    "hairball": SceneConfig(kind="hairball", size=(48, 40), depth_complexity=N, mean_depth=4, seed=9),
    "crossing": SceneConfig(size=(48, 40), depth_complexity=N, slant=0.7, layout="mixed", mean_depth=5, seed=10),
    "rejecting needles": SceneConfig(kind="needles", size=(48, 40), depth_complexity=N, fragment_probability=0.5),
}
ALIKE = ("reverse-sorted", "tiles")  # what options are tested on
KS = (1, 4, 32)  # the Z-buffer's, fewer than the fragments, more than the fragments


def contents(config: SceneConfig) -> str:
    """What a scene takes from files and packages, which may change under one name, as text; by digest."""
    return json.dumps(kind_of(config).record(config), sort_keys=True)


def scene(config: SceneConfig) -> Geometry:
    return _scene(config, contents(config))


@cache
def _scene(config: SceneConfig, _contents: str) -> Geometry:
    return generate(config)


class Stage(Shown):
    """A scene on the device, with its statistics and its oracle's images."""

    def __init__(self, device, config: SceneConfig):
        super().__init__(device, scene(config))
        self.answer = cache(self.truth.answer)


def layers_for(variant: Variant) -> int:
    """N, or as many layers as make two classes of pixels where the variant has classes."""
    return TWO_CLASSES if variant.params.get("bma") == "on" else N


def alike(variant: Variant) -> dict[str, SceneConfig]:
    """The scenes that a choice of one parameter is tested on."""
    return {name: replace(SCENES[name], depth_complexity=layers_for(variant)) for name in ALIKE}


STAGES: dict[tuple[SceneConfig, str], Stage] = {}  # kept: captures and images are the same for every method


def stage(device, config: SceneConfig) -> Stage:
    key = config, contents(config)
    if key not in STAGES:
        STAGES[key] = Stage(device, config)
    return STAGES[key]


def stats_in(device, config: SceneConfig) -> SceneStats:
    return stage(device, config).stats


class Drawn:
    """Frames of a variant: the last image, the number of distinct ones, losses, memory declared and allocated."""

    def __init__(self, device, variant: Variant, config: SceneConfig, frames: int = 1, probing: bool = False):
        on = stage(device, config)
        fitted = Fitted(variant, on.stats, device.features)
        frame = Frame(device, fitted, on.scene_buffer, on.canvas)
        digests = set()
        for _ in range(frames):
            frame.draw_fitting()
            self.image = frame.image()
            digests.add(self.image.tobytes())
        self.distinct_images = len(digests)
        self.lost = frame.lost_fragments()
        self.passes, self.kept = frame.geometry_passes, fitted.kept()
        self.probed = frame.probe() if probing else {}
        self.passes_probing, self.image_probing = frame.geometry_passes, frame.image()
        self.allocated, self.declared = frame.memory_bytes, fitted.memory_bytes()
        promised = on.answer(fitted.promise())
        self.error = conformance(self.image, promised, promised.given_by(variant.method))["max_abs_error"]
        self.fits = all(size <= self.declared[name] for name, size in self.allocated.items())
        frame.release()
        device.check(label(variant))


def runs_here(device, variant: Variant) -> bool:
    return device.features.issuperset(variant.needs)
