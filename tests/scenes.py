"""Scenes for property tests: whole configs, and quads placed without any layout."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.scene.quads import Quads

seeds = st.integers(0, 2**32 - 1)
shares = st.sampled_from([0.001, 0.1, 0.25, 0.5, 0.77, 0.999, 1.0]) | st.floats(1e-3, 1.0)
sides = st.integers(1, 70)


@st.composite
def configs(draw, **fixed) -> SceneConfig:
    """Any small scene config; `fixed` fields are given."""
    alphas = sorted(draw(st.tuples(st.floats(0, 1), st.floats(0, 1))))
    chosen = {
        "size": draw(st.tuples(sides, sides)), "pixel_density": draw(shares),
        "depth_complexity": draw(st.integers(0, 12)),
        "layout": draw(st.sampled_from(["block", "tiles", "random", "mixed"])),
        "order": draw(st.sampled_from(["random", "front_to_back", "back_to_front"])), "alpha": tuple(alphas),
        "fragment_probability": draw(shares), "seed": draw(seeds),
    } | fixed
    if chosen["layout"] == "random":
        chosen["quad_size"] = draw(st.none() | st.tuples(st.integers(4, 20), st.integers(4, 20)))
    if chosen["layout"] == "block":
        chosen["least_depth"] = draw(st.none() | shares)
    return SceneConfig(**chosen)


@st.composite
def placed(draw, most: int = 8) -> Quads:
    """Up to `most` quads anywhere on a viewport of a few pixels, at distinct depths."""
    width, height = draw(st.integers(1, 7)), draw(st.integers(1, 7))
    depths = draw(st.lists(st.integers(1, 2**23 - 1), max_size=most, unique=True))
    rects = [[*edges_x, *edges_y] for edges_x, edges_y in
             (sorted_pairs(draw, width, height) for _ in depths)]
    rect = np.array(rects, dtype=np.int32).reshape(-1, 4)[:, [0, 2, 1, 3]]
    rgba = draw(st.lists(st.tuples(*[st.integers(0, 255)] * 4), min_size=len(depths), max_size=len(depths)))
    return Quads((width, height), rect, (np.array(depths) / 2**23).astype(np.float32),
                 np.array(rgba, dtype=np.uint8).reshape(-1, 4), draw(st.sampled_from([1.0, 0.5, 0.1])), draw(seeds),
                 draw(st.integers(0, len(depths))))


def sorted_pairs(draw, width: int, height: int) -> list[list[int]]:
    """Two different edges in each direction."""
    return [sorted(draw(st.lists(st.integers(0, side), min_size=2, max_size=2, unique=True)))
            for side in (width, height)]
