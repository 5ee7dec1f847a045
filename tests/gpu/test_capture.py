"""The oracle of slanted scenes: the device's own fragments, all of them, and the analytic oracle's on flat quads."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.errors import DeviceError
from mfr_bench.gpu import capture as capturing
from mfr_bench.gpu.capture import capture
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, Promise
from mfr_bench.oracle import composite as oracle
from mfr_bench.oracle.composite import composite, fragment_counts, stats_of
from mfr_bench.plan import Cell, expected_stats, judge
from mfr_bench.scene import generate
from mfr_bench.scene.strips import Strips

FLAT = [SceneConfig(size=(97, 71), depth_complexity=9, layout="mixed", mean_depth=5, seed=4),
        SceneConfig(size=(97, 71), depth_complexity=9, layout="tiles", pixel_density=0.5, fragment_probability=0.4),
        SceneConfig(size=(5, 3), depth_complexity=0)]
STANDINS = [(kind, layers, mean) for kind in ("hairball", "needles", "temple")
            for layers, mean in ((20, 8), (180, 60), (180, 100))]


@pytest.fixture
def on(device):
    """on(config) -> the scene on the device"""
    opened = []

    def show(config, frame=0):
        context = shown(device, generate(config, frame))
        opened.append(context)
        return context.__enter__()

    yield show
    for context in opened:
        context.__exit__(None, None, None)


def lists(scene):
    """The analytic oracle's fragments: by pixel, depth bits and primitive from the nearest to the furthest."""
    width, height = scene.viewport
    found = [[] for _ in range(width * height)]
    for quad in scene.depth_order:
        x0, y0, x1, y1 = scene.rasterized[quad]
        mask = scene.kept(quad, x0, y0, x1, y1)
        for y, x in np.argwhere(mask):
            found[(y + y0) * width + x + x0].append((int(scene.depth[quad].view(np.uint32)), int(quad)))
    return found


@pytest.mark.parametrize("config", FLAT)
def test_a_capture_of_flat_quads_is_the_analytic_lists_bit_for_bit(device, on, config):
    stage = on(config)
    scene, found = stage.scene_buffer.scene, capture(device, stage.scene_buffer, stage.canvas)
    assert (found.counts == fragment_counts(scene)).all()
    expected = [fragment for pixel in lists(scene) for fragment in pixel]
    assert found.depth.tolist() == [depth for depth, _ in expected]
    assert found.primitive.tolist() == [primitive for _, primitive in expected]
    assert not found.coincident.any()


@pytest.mark.parametrize("config", FLAT)
@pytest.mark.parametrize("promise", [Promise(), Promise(1), Promise(3), Promise(99), Promise(3, "furthest"),
                                     Promise(3, "opaque")], ids=str)
def test_both_oracles_give_one_image_of_flat_quads(device, on, config, promise):
    stage = on(config)
    found = capture(device, stage.scene_buffer, stage.canvas)
    expected = composite(stage.scene_buffer.scene, promise.layers, promise.criterion)
    np.testing.assert_allclose(found.composite(promise.layers, promise.criterion), expected, rtol=0, atol=1e-12)


def test_a_capture_in_pieces_is_the_capture(device, on, monkeypatch):
    stage = on(SceneConfig(kind="hairball", size=(64, 48), depth_complexity=20, mean_depth=8))
    whole = capture(device, stage.scene_buffer, stage.canvas)
    image = whole.composite(4)
    monkeypatch.setattr(capturing, "CHUNK_BYTES", 8 * 1000)
    monkeypatch.setattr(oracle.in_chunks, "__defaults__", (700,))
    pieces = capture(device, stage.scene_buffer, stage.canvas)
    assert len(list(oracle.in_chunks(whole.counts.ravel(), 1000))) > 10
    for name in ("counts", "depth", "primitive", "coincident"):
        np.testing.assert_array_equal(getattr(pieces, name), getattr(whole, name))
    np.testing.assert_array_equal(pieces.composite(4), image)


@pytest.mark.parametrize("by", [-1, 1])
def test_a_fragment_more_or_less_than_counted_is_an_error(device, on, monkeypatch, by):
    stage = on(SceneConfig(kind="temple", size=(64, 48), depth_complexity=6))

    def miscounted(*arguments, real=capturing.count):
        counts = real(*arguments)
        counts[24, 32] += by
        return counts

    monkeypatch.setattr(capturing, "count", miscounted)
    with pytest.raises(DeviceError, match="the device draws one scene in two ways"):
        capture(device, stage.scene_buffer, stage.canvas)


@pytest.mark.parametrize(("colour", "tied"), [((100, 100, 100, 100), 0), ((50, 100, 100, 100), 16)])
def test_fragments_of_equal_depth_are_told(device, colour, tied):
    """Two strips over the left half share their depth; a third, over all, does not. Equal colours tie nothing."""
    corners = np.array([[-1, -1, 0.5, 1], [0, -1, 0.5, 1], [-1, 1, 0.5, 1], [0, 1, 0.5, 1]], dtype=np.float32)
    whole = corners * np.array([1, 1, 0.5, 1]) + np.array([0, 0, 0, 0]) + (corners[:, :1] == 0) * np.eye(4)[0]
    scene = Strips((8, 4), np.stack([corners, corners, whole]).astype(np.float32),
                   np.array([[100, 100, 100, 100], colour, [9, 9, 9, 100]], dtype=np.uint8), 1.0, 1)
    with shown(device, scene) as stage:
        found = capture(device, stage.scene_buffer, stage.canvas)
        assert found.counts.tolist() == [[3] * 4 + [1] * 4] * 4
        assert found.coincident.tolist() == [[True] * 4 + [False] * 4] * 4
        assert found.primitive[:3].tolist() == [2, 0, 1]  # equal depths in order of submission
        submitted = stage.truth.image(Promise())
        assert stage.errors(catalog()["peel-f2b"].variant({}), submitted) == {
            "max_abs_error": 0, "wrong_pixels": 0, "tied_pixels": tied, "tied_error": 0, "order_error": 0}


def test_a_truth_is_of_the_scene_that_it_was_made_for(on):
    config = SceneConfig(kind="temple", size=(64, 48), depth_complexity=6)
    stage = on(config)
    stage.scene_buffer.replace(generate(replace(config, seed=9)))
    with pytest.raises(ValueError, match="another scene is on the device"):
        stage.truth.image(Promise())


@pytest.mark.parametrize(("kind", "layers", "mean"), STANDINS)
def test_a_stand_in_has_its_maximum_and_about_its_mean(on, kind, layers, mean):
    if kind == "temple" and mean == 100:
        layers = 160
    stats = on(SceneConfig(kind=kind, size=(256, 256), depth_complexity=layers, mean_depth=mean)).stats
    covered = sum(stats.histogram[1:])
    assert stats.n == layers
    assert pytest.approx(mean, rel=0.06) == stats.F / covered
    expected = expected_stats(SceneConfig(kind=kind, size=(256, 256), depth_complexity=layers, mean_depth=mean))
    assert pytest.approx(stats.F, rel=0.15) == expected.F
    assert pytest.approx(covered, rel=0.1) == sum(expected.histogram[1:])
    assert stats.primitives <= 1.01 * expected.primitives <= 3 * stats.primitives


@pytest.mark.parametrize("kind", ["hairball", "needles", "temple"])
def test_stand_ins_go_from_sparse_to_dense(on, kind):
    """Covered pixels follow the density, and the maximum stays."""
    stats = [on(SceneConfig(kind=kind, size=(256, 256), depth_complexity=20, mean_depth=8, pixel_density=density)).stats
             for density in (0.1, 0.3, 0.9)]
    covered = [sum(s.histogram[1:]) for s in stats]
    assert [s.n for s in stats] == [20] * 3
    assert covered[1] / covered[0] == pytest.approx(3, rel=0.15)
    assert covered[2] / covered[1] == pytest.approx(3, rel=0.15)


def test_an_animation_changes_how_deep_pixels_are(on):
    config = SceneConfig(kind="hairball", size=(96, 96), depth_complexity=60, mean_depth=15, animate=True)
    means = [stats.F / sum(stats.histogram[1:]) for stats in (on(config, frame).stats for frame in (0, 2, 4))]
    assert means[0] < means[1] < means[2]


@pytest.mark.parametrize("given", [{"kind": "hairball"}, {"slant": 0.5}])
def test_methods_that_need_flat_primitives_say_so(device, on, given):
    """Multisampling may take depths elsewhere than in the middle of the pixel."""
    config = SceneConfig(size=(64, 48), depth_complexity=6, **given)
    params = catalog()["peel-srab"].complete({})
    cell = Cell("e", "peel-srab", "l", params, config, None, {})
    assert judge(cell, catalog(), on(config).stats, device.limits) == (
        "unsupported", "needs flat primitives that meet no pixel but at its edges")
    flat = replace(cell, scene=SceneConfig(size=(64, 48), depth_complexity=6), measure=_Budget)
    assert judge(flat, catalog(), on(flat.scene).stats, None) is None
    assert judge(replace(cell, measure=_Budget, params=params | {"multisampling": "off"}), catalog(), on(config).stats,
                 None) is None


class _Budget:
    memory_budget_mb = 100.0


def test_probes_see_every_fragment_where_tiles_are_covered(device, on):
    """The image is drawn over whole tiles right after; llvmpipe drops what came before unless it is waited for."""
    config = SceneConfig(size=(200, 150), depth_complexity=3)
    stage = on(config)
    frame = Frame(device, Fitted(catalog()["ab-array"].variant({}), stage.stats), stage.scene_buffer, stage.canvas)
    frame.draw_fitting()
    assert frame.probe() == {"stored_fragments": stats_of(generate(config)).F}
    frame.release()
