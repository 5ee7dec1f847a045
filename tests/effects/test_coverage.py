"""Samples of a pixel: masks, depths and images of every method that can, against models and by hand."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config.model import Measure
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.effects import COVERAGES, MSAA, Settings
from mfr_bench.effects.coverage import covered, model, packed, samples_of, straight_of
from mfr_bench.effects.rays import Rays
from mfr_bench.glsl import stages
from mfr_bench.gpu.capture import capture
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.samples import masks_of, places, soup, tried
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import MSAA_FEATURES, SCENE_FACTS, Fitted
from mfr_bench.oracle.rasterizer.masks import depth_inside, disagreements
from mfr_bench.plan import Cell, Limits, expected_stats, judge
from mfr_bench.resources import configs_dir
from mfr_bench.scene import generate
from mfr_bench.scene.parts import in_samples
from mfr_bench.scene.triangles import Triangles
from mfr_bench.store.status import EXACT_ERROR

SLANTED = {"size": (24, 20), "depth_complexity": 5, "slant": 0.3, "layout": "random", "seed": 3}
EMULATED = {"atomic64": "emulated"}


def variant_of(method, **more):
    return method.variant({name: value for name, value in {**EMULATED, **more}.items() if method.param(name)})


OF_ONE_SAMPLE = {"blended", "one_sample", "unmasked"}
EXACT = [m for m in catalog().values()
         if variant_of(m).guarantee.startswith("exact") and not OF_ONE_SAMPLE.intersection(variant_of(m).asks)]


def seen(device):
    """The sample counts above one that the device rasterizes."""
    return [count for count, feature in MSAA_FEATURES.items() if feature in device.features]


@pytest.fixture(scope="module")
def on_samples(device):
    """A slanted scene on the device in each coverage, at the most samples that it has."""
    counts = seen(device)
    if not counts:
        pytest.skip("this device rasterizes into one sample a pixel")
    contexts = {name: shown(device, generate(SceneConfig(**SLANTED, msaa=counts[-1], coverage=name)))
                for name in COVERAGES}
    yield {name: context.__enter__() for name, context in contexts.items()}
    for context in contexts.values():
        context.__exit__(None, None, None)


@pytest.mark.parametrize("method", EXACT, ids=lambda m: m.id)
def test_every_exact_method_that_can_is_exact_in_samples(method, on_samples, device):
    """Images of all fragments, or of fewer than a pixel has: each way to use coverage, in one method of each kind."""
    variant = variant_of(method, k=6)
    if not device.features.issuperset(variant.needs):
        pytest.skip(f"needs {', '.join(variant.needs)}")
    for name in COVERAGES if method.id in ("ab-ll", "kplus-array") else ("samples",):
        found = on_samples[name].errors(variant, on_samples[name].render(variant))
        assert found["max_abs_error"] <= EXACT_ERROR, name


@pytest.mark.parametrize("method", ["open-post", "lin-post"])
def test_depths_beyond_the_triangles_stay_on_the_grid_that_methods_need(method, device):
    """A steep triangle whose middle lies outside has no depth below 1/2, where 24 bits would not hold it."""
    for count in seen(device):
        config = SceneConfig(kind="mesh", file=str(configs_dir() / "meshes" / "knot.obj"), size=(49, 37),
                             alpha=(0.1, 0.6), depth_complexity=0, opaque="store", msaa=count)
        with shown(device, generate(config)) as on:
            frame = Frame(device, Fitted(variant_of(catalog()[method]), on.stats), on.scene_buffer, on.canvas)
            frame.draw_fitting()
            assert frame.lost_fragments() == 0
            frame.release()


def test_most_exact_methods_can(on_samples):
    assert len(EXACT) > 20


@pytest.mark.parametrize("chosen", [{"sort": "lplus"}, {"sort": "register"}, {"bma": "on"}, {"resolve": "compute"},
                                    {"payload": "rgba16f"}, {"touched": "tiles"}, {"touched": "bounds"}], ids=str)
def test_every_way_to_resolve_is_exact_in_samples(chosen, on_samples):
    on, variant = on_samples["samples"], catalog()["ab-array"].variant(chosen)
    assert on.errors(variant, on.render(variant))["max_abs_error"] <= EXACT_ERROR


@pytest.mark.parametrize("perspective", [False, True])
def test_masks_are_those_of_a_rasterizer_in_float64(perspective, device):
    """Samples apart that lie within 1/128 of a pixel from an edge; the depth is that of the middle of the pixel."""
    for count in seen(device):
        flat = soup((40, 30), 40, seed=9)
        corners = flat.position * (np.random.default_rng(1).uniform(1, 3, (40, 3, 1)) if perspective else 1)
        scene = in_samples(replace(flat, position=corners.astype(np.float32)), Settings(msaa=count))
        with shown(device, scene) as on:
            found = capture(device, on.scene_buffer, on.canvas)
        ndc = scene.position.astype(np.float64)[..., :3] / scene.position.astype(np.float64)[..., 3:]
        window = (ndc[..., :2] + 1) / 2 * scene.viewport
        assert not disagreements(masks_of(found), depth_inside(window, scene.viewport, places(device, count))).any()
        pixel, triangle = found.of_pixels(), found.primitive
        middle = np.stack([pixel % 40 + 0.5, pixel // 40 + 0.5], axis=-1)
        expected = _depth_at(np.dstack([window, (ndc[..., 2] + 1) / 2])[triangle], middle)
        expected = np.clip(expected, *scene.depth_bounds)
        assert np.abs(found.depth.view(np.float32) - expected).max() < 1e-4


def _depth_at(corners, places):
    """The planes through corners (n, 3, 3) at places (n, 2)."""
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(one, other)
    away = places - corners[:, 0, :2]
    return corners[:, 0, 2] - (normal[:, 0] * away[:, 0] + normal[:, 1] * away[:, 1]) / normal[:, 2]


def test_blending_by_the_device_in_samples_is_the_oracle_of_samples(device):
    """Triangles of one depth each, drawn back to front: what fixed-function multisampling makes of them."""
    for count in seen(device):
        flat = soup(count=25, seed=4)
        flat.position[..., 2] = np.linspace(0.9, -0.9, 25, dtype=np.float32)[:, None]
        with shown(device, in_samples(flat, Settings(msaa=count))) as on:
            image = on.render(catalog()["floor"].variant({}))
            np.testing.assert_allclose(image, on.truth.reference().image, atol=EXACT_ERROR)


def wedge(alpha=0.5):
    """Two triangles that share the diagonal of the viewport, of one colour and depth."""
    corners = np.ones((2, 3, 4), dtype=np.float32)
    corners[..., :2] = [[(-1, -1), (1, -1), (1, 1)], [(-1, -1), (1, 1), (-1, 1)]]
    corners[..., 2] = 0.25
    rgba = np.tile(np.uint8([255, 0, 255, round(255 * alpha)]), (2, 1))
    return Triangles((16, 12), corners, rgba, 1.0, 1, np.zeros(2, np.int32))


@pytest.mark.parametrize("name", COVERAGES)
def test_the_wire_frame_is_as_large_as_two_opacities_make_it(name, device):
    """Nothing shows of the edge in samples; with alpha a little less than the opacity, ignored nearly twice as much."""
    for count in seen(device):
        with shown(device, in_samples(wedge(), Settings(msaa=count, coverage=name))) as on:
            image = on.render(catalog()["ab-ll"].variant({}))
            fragments = capture(device, on.scene_buffer, on.canvas)
        a = straight_of(packed(wedge().rgba))[0, 3]
        share = np.zeros(fragments.counts.size)
        share[fragments.of_pixels()] = samples_of(fragments.payloads(), count).mean(axis=1)
        twice = (fragments.counts == 2).ravel()
        assert twice.sum() >= 12
        expected = {"samples": np.full(twice.size, a), "alpha": 1 - (1 - a * share) * (1 - a * (1 - share)),
                    "ignored": np.where(twice, 1 - (1 - a) ** 2, a)}[name]
        np.testing.assert_allclose(image[..., 3].ravel(), expected, atol=1e-6)


def test_words_hold_masks_and_the_nearest_shades():
    rgba = np.random.default_rng(2).integers(0, 256, (500, 4), dtype=np.uint8)
    masks = np.random.default_rng(3).integers(1, 256, 500, dtype=np.uint8)
    words = covered(packed(rgba), masks)
    np.testing.assert_array_equal(words, packed(rgba, masks))
    np.testing.assert_array_equal((samples_of(words, 8) << np.arange(8)).sum(axis=1), masks)
    assert np.abs(straight_of(words) - rgba / 255).max() <= 0.5 / 63 + 1e-12


@pytest.mark.parametrize("msaa", MSAA[1:])
def test_the_model_composites_each_sample_by_itself(msaa):
    numbers = np.random.default_rng(msaa)
    masks = numbers.integers(1, 1 << msaa, 6, dtype=np.uint8)
    payloads = packed(numbers.integers(0, 256, (6, 4), dtype=np.uint8), masks)
    found = model(Rays(np.array([6]), np.linspace(0, 1, 6), payloads), Settings(msaa=msaa))[0]
    stacks = []
    for sample in range(msaa):
        colour, through = np.zeros(3), 1.0
        for mask, (r, g, b, a) in zip(masks, straight_of(payloads), strict=True):
            if mask >> sample & 1:
                colour, through = colour + through * a * np.array([r, g, b]), through * (1 - a)
        stacks.append([*colour, 1 - through])
    np.testing.assert_allclose(found, np.mean(stacks, axis=0), atol=1e-12)


def test_a_device_with_these_samples_passes_the_trial(device):
    for count in seen(device):
        assert tried(device, count)[0], tried(device, count)[1]


@pytest.mark.parametrize(("method", "fact"), [("peel-f2b", "blended"), ("wboit", "blended"), ("zbuffer", "blended"),
                                              ("kb-sr", "one_sample"), ("kb-mdt32", "unmasked"),
                                              ("ab-ll-bucket", "blended")])
def test_what_cannot_is_unsupported_and_says_why(method, fact):
    config = SceneConfig(**SLANTED, msaa=4)
    declared = catalog()[method]
    said = judge(Cell("msaa", method, method, declared.complete({}), config, Measure(), {}), catalog(),
                 expected_stats(config), None)
    assert said[0] == "unsupported" and SCENE_FACTS[fact] in said[1]


def test_a_device_without_so_many_samples_is_said_so():
    config = SceneConfig(**SLANTED, msaa=8)
    cell = Cell("msaa", "ab-ll", "ab-ll", catalog()["ab-ll"].complete({}), config, Measure(), {})
    trial = "the trial 'coverage masks' (2 wrong)"
    limits = Limits(frozenset({"msaa_4"}), 2**27, 2**14, failed_trials={"msaa_8": trial})
    assert judge(cell, catalog(), expected_stats(config), limits) == (
        "unsupported", f"needs msaa_8, which fails {trial}")
    assert judge(replace(cell, scene=SceneConfig(**SLANTED, msaa=4)), catalog(),
                 expected_stats(SceneConfig(**SLANTED, msaa=4)), limits) is None


@pytest.mark.parametrize("method", catalog().values(), ids=lambda method: method.id)
def test_nothing_of_samples_is_in_shaders_of_one_sample(method):
    fitted = Fitted(variant_of(method), expected_stats(SceneConfig(**SLANTED)))
    for step in fitted.variant.passes:
        for stage in stages(fitted, step) if step.kind != "clear" else ():
            assert not {"MSAA", "SAMPLED_DEPTH", "MASK_BITS", "gl_SampleMask["} & set(stage.code.split())
            assert "payload_of_covered" not in stage.code and "rejected_in_samples" not in stage.code


def test_records_of_scenes_of_one_sample_know_none():
    assert not {"msaa", "coverage"} & SceneConfig(**SLANTED).as_dict().keys()
    record = SceneConfig(**SLANTED, msaa=2, coverage="alpha").as_dict()
    assert Settings.of(record) == Settings(msaa=2, coverage="alpha")
