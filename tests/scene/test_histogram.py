"""`kind: histogram`: exactly so many pixels of each depth complexity, however clustered."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mfr_bench.config import load
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.errors import UsageError
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.oracle.listed import counts_of
from mfr_bench.plan import expand, expected_stats
from mfr_bench.scene import generate


def scene(size, pixels, **keys):
    return SceneConfig(kind="histogram", size=size, depth_complexity=0, pixels=tuple(pixels), **keys)


@st.composite
def scenes(draw):
    size = draw(st.tuples(st.integers(1, 40), st.integers(1, 40)))
    left, pixels = size[0] * size[1], []
    for _ in range(draw(st.integers(0, 9))):
        pixels.append(draw(st.integers(0, left)))
        left -= pixels[-1]
    return scene(size, [*pixels, left], cluster=draw(st.integers(1, 50)), seed=draw(st.integers(0, 2**32 - 1)))


@settings(max_examples=60, deadline=None)
@given(scenes())
def test_the_histogram_is_met_exactly(config):
    counts = counts_of(generate(config))
    assert np.bincount(counts.ravel(), minlength=len(config.pixels)).tolist() == list(config.pixels)


@pytest.mark.parametrize("cluster", [1, 8, 32])
def test_the_plan_a_device_and_methods_see_it(cluster, device):
    config = scene((96, 64), [1000, 2144, 2000, 700, 0, 300], cluster=cluster, seed=5)
    expected = expected_stats(config)
    with shown(device, generate(config)) as on:
        assert on.stats.histogram == expected.histogram == config.pixels
        assert on.stats.primitives <= 3 * expected.primitives <= 9 * on.stats.primitives
        for name in ("ab-array", "ab-ll", "peel-f2b", "kplus-array"):
            method = catalog()[name].variant({})
            assert on.errors(method, on.render(method))["max_abs_error"] <= 1e-4


def neighbours_alike(config):
    """Share of pixels whose right neighbour has as many fragments."""
    counts = counts_of(generate(config))
    return (counts[:, 1:] == counts[:, :-1]).mean()


def test_a_larger_cluster_has_more_neighbours_of_one_depth():
    alike = [neighbours_alike(scene((128, 128), [4096] * 4, cluster=cluster)) for cluster in (1, 4, 16, 64)]
    assert alike[0] == pytest.approx(0.25, abs=0.02)
    assert alike == sorted(alike) and alike[-1] > 0.9


def test_orders_and_distinct_depths():
    config = scene((16, 16), [0, 128, 64, 64], order="back_to_front")
    depth = generate(config).depth
    assert (np.diff(depth) < 0).all()


def test_a_viewport_without_fragments():
    assert len(generate(scene((8, 8), [64]))) == 0


@pytest.mark.parametrize(("keys", "line"), [
    ("pixels: [10, 3]", "13 pixels for a viewport of 16; allowed: numbers that add up to 16"),
    ("pixels: []", "0 pixels for a viewport of 16"),
    ("pixels: [-1, 17]", "allowed: a list of whole numbers of pixels"),
    ("pixels: [16], pixel_density: 0.5", "pixel_density has no use in kind histogram"),
    ("pixels: [16], cluster: 0", "allowed: a whole number from 1"),
    ("pixels: [16], order: file", "order 'file' has no use in kind histogram")])
def test_a_bad_histogram_is_one_line(tmp_path, keys, line):
    path = tmp_path / "h.yaml"
    path.write_text(f"name: h\nscene: {{kind: histogram, size: [4, 4], {keys}}}\nmethods: [ab-array]\n")
    with pytest.raises(UsageError) as error:
        expand(load(str(path), catalog())[0], catalog())
    assert len(error.value.lines) == 1 and line in error.value.lines[0]


def test_more_quads_than_distinct_depths_are_refused(monkeypatch):
    monkeypatch.setattr("mfr_bench.scene.histogram.MAX_PRIMITIVES", 10)
    with pytest.raises(UsageError, match=r"quads; allowed: at most 10, so that depths stay distinct"):
        generate(scene((8, 8), [32, 32]))
