"""Resolves that touch only tiles with fragments: the image is the whole one, the list what the counters have."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.work import work_of
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import TILE_COMMAND, TILE_LIST
from mfr_bench.quality import EXACT_ERROR

from ..contract.cases import Drawn, stage

BASE = SceneConfig(size=(75, 53), depth_complexity=9, seed=11)
SCENES = {
    **{f"{layout} {density}": replace(BASE, layout=layout, pixel_density=density)
       for layout in ("block", "tiles") for density in (0.05, 1.0)},
    "random": replace(BASE, layout="random", quad_size=(5, 3)),
    "crossing": SceneConfig(size=(48, 40), depth_complexity=9, slant=0.7, layout="mixed", mean_depth=5, seed=10),
    "nothing": replace(BASE, depth_complexity=0),
}
METHODS = [m for m in catalog().values() if (touched := m.param("touched")) and "tiles" in touched.choices]
RESOLVES = [{"bma": bma, "resolve": stage} for bma in ("off", "on") for stage in ("fragment", "compute")]


def tiled(method, **more):
    return method.variant({"touched": "tiles", **more} | ({"k": 4} if method.param("k") else {}))


@pytest.mark.parametrize("more", RESOLVES, ids=lambda more: "-".join(more.values()))
@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.id)
def test_every_resolve_by_tiles_is_exact(device, method, more):
    for name, config in SCENES.items():
        drawn = Drawn(device, tiled(method, **more), config, frames=2, probing=True)
        assert drawn.error <= EXACT_ERROR, name
        assert drawn.lost == 0, name
        assert drawn.allocated == drawn.declared, name
        assert all(held == drawn.kept for counter, held in drawn.probed.items() if counter == "held_fragments"), name


@pytest.mark.parametrize("name", SCENES)
def test_the_list_holds_each_tile_with_fragments_once(device, name):
    on = stage(device, SCENES[name])
    frame = Frame(device, tiled(catalog()["ab-sb"]), on.sizes, on.quads, on.canvas)
    try:
        frame.draw_fitting()
        counts = np.flatnonzero(frame.words("counter"))
        tiles = {int(p % on.sizes.W // 16 + -(-on.sizes.W // 16) * (p // on.sizes.W // 16)) for p in counts}
        command = frame.words(TILE_COMMAND)
        assert sorted(frame.words(TILE_LIST)[:command[1]]) == sorted(tiles)
        assert command.tolist() == [4, len(tiles), 0, 0, len(tiles), 1, 1, 0]
    finally:
        frame.release()


def test_only_listed_tiles_are_resolved(device):
    """The pixels that the resolve's draw passes are those of the tiles with fragments."""
    on = stage(device, SCENES["block 0.05"])
    frame = Frame(device, tiled(catalog()["ab-array"]), on.sizes, on.quads, on.canvas)
    try:
        frame.draw_fitting()
        listed = int(frame.words(TILE_COMMAND)[1])
        assert 0 < work_of(frame)["resolve"]["passed"] <= 256 * listed < on.sizes.P / 2
    finally:
        frame.release()
