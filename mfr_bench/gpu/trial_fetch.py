"""The trial of framebuffer fetch: whether each fragment of a pixel sees there what the one before has left."""

from __future__ import annotations

import numpy as np

from ..methods.spec import IMAGE, Pass, Target
from ..scene import Scene as SceneConfig
from .context import Device
from .probes import ProbeBench, probe_method

SCENE = SceneConfig(size=(24, 20), depth_complexity=3)  # quads that cover all pixels
SEEN = (1, 0)  # of the target before: a number that grows by a digit for each fragment, and a counter
FETCHED = probe_method(
    "framebuffer fetch",
    Pass("fetch", "geometry", "probe/fetch.frag", into=("seen", IMAGE), fetched=("seen",), keeps=(IMAGE,),
         clears={"seen": SEEN}),
    Pass("show", "fullscreen", "probe/show_fetched.frag", into=("seen", IMAGE), fetched=("seen",), keeps=("seen",)),
    targets=(Target("seen", "rg32ui"),))


def fetched(device: Device) -> tuple[bool, str]:
    """Whether fragments find the pixel as those before left it, in order of submission, and a later pass as well."""
    with ProbeBench(device, SCENE) as bench:
        frame = bench.frame(FETCHED)
        frame.draw()
        image, quads = frame.image(), bench.stats.n
        frame.release()
    digits = SEEN[0]
    for quad in range(quads):
        digits = quads * digits + quad
    right = int((image[..., :2] == np.array((digits, quads))).all(axis=-1).sum())
    return right == image[..., 0].size, f"{right} of {image[..., 0].size} pixels with every fragment in order"
