"""The device rasterizes depths at their extremes as the oracle takes them."""

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.oracle.composite import stats_of
from mfr_bench.scene import generate
from mfr_bench.scene.stress import ODD_DEPTHS


def arrived(device, config: SceneConfig) -> np.ndarray:
    """float32 depths of every fragment of pixel 0, ascending, as the shaders get them."""
    scene = generate(config)
    stats = stats_of(scene)
    quads, canvas = SceneBuffer(device, scene), Canvas(device, (stats.W, stats.H))
    frame = Frame(device, Fitted(catalog()["ab-array"].variant({}), stats), quads, canvas)
    frame.draw()
    count = frame.words("counter")
    assert (count == count[0]).all()
    depths = frame.words("nodes").reshape(-1, stats.P, 2)[:count[0], 0, 0].view(np.float32)
    for thing in (frame, canvas, quads):
        thing.release()
    return np.sort(depths)


@pytest.mark.parametrize(("at", "gap"), [(0.0, -24), (0.5, -24), (1.0, -24), (0.0, -126), (0.5, -4)])
def test_every_bit_of_a_depth_arrives(device, at, gap):
    if gap < -24 and not device.gl.glClipControl:
        pytest.skip("this device has no clip control")
    config = SceneConfig(size=(3, 2), depth_complexity=8, depth_at=at, depth_gap_log2=gap)
    expected = np.sort(generate(config).depth)
    assert arrived(device, config).tobytes() == expected.tobytes()


@pytest.mark.parametrize("odd", ODD_DEPTHS)
def test_odd_depths_are_clipped_as_the_oracle_clips_them(device, odd):
    config = SceneConfig(size=(3, 2), depth_complexity=5, odd_depth=odd)
    depth = generate(config).depth
    seen = np.sort(depth[(depth >= 0) & (depth <= 1)])
    assert np.array_equal(arrived(device, config), seen)


@pytest.mark.parametrize("overhang", [1, 2**12, 2**24])
def test_far_corners_cost_no_fragment(device, overhang):
    config = SceneConfig(size=(37, 29), depth_complexity=3, overhang=overhang)
    assert len(arrived(device, config)) == 3
