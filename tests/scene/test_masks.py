"""Coverage masks of recorded fragments: read, written, drawn with any number of samples on any device."""

import numpy as np
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.effects import COVERAGES, MSAA
from mfr_bench.errors import UsageError
from mfr_bench.gpu.capture import capture
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Promise
from mfr_bench.oracle.listed import recorded
from mfr_bench.resources import configs_dir
from mfr_bench.scene import generate
from mfr_bench.scene.kinds import kind_of
from mfr_bench.scene.recording import Recording, samples_of
from mfr_bench.store.status import EXACT_ERROR

SIZE = (11, 9)
ALL = Promise()


def random_recording(msaa, count=400):
    """Fragments of distinct depths and any mask that so many samples have."""
    numbers = np.random.default_rng(msaa)
    return Recording(SIZE, numbers.integers(0, SIZE, (count, 2)).astype(np.int32),
                     ((numbers.permutation(count) + 0.5) / count).astype(np.float32),
                     numbers.integers(0, 256, (count, 4), dtype=np.uint8),
                     coverage=numbers.integers(1, 1 << msaa, count, dtype=np.uint8))


def scene_of(folder, recording, **more):
    (folder / "recorded.npz").write_bytes(recording.packed())
    return SceneConfig(kind="fragments", file="recorded.npz", folder=str(folder), size=recording.viewport,
                       depth_complexity=0, order="file", **more)


def variant_of(method):
    return method.variant({name: value for name, value in {"atomic64": "emulated", "k": 4, "sort": "insertion"}.items()
                           if method.param(name)})


@pytest.mark.parametrize("msaa", MSAA[1:])
def test_every_exact_method_that_hands_on_is_exact_on_masks_of_every_number_of_samples(msaa, device, tmp_path):
    """The device may rasterize into fewer samples, or one: masks come with the fragments."""
    drawn = 0
    with shown(device, generate(scene_of(tmp_path, random_recording(msaa), msaa=msaa))) as on:
        for method in catalog().values():
            variant = variant_of(method)
            lacking = [fact for fact in variant.asks if not getattr(on.stats, fact)]
            if variant.guarantee.startswith("exact") and not lacking and device.features.issuperset(variant.needs):
                assert on.errors(variant, on.render(variant))["max_abs_error"] <= EXACT_ERROR, method.id
                drawn += 1
    assert drawn > 20


@pytest.mark.parametrize("coverage", COVERAGES)
def test_a_recording_of_a_scene_in_samples_has_its_image(coverage, device, tmp_path):
    if "msaa_4" not in device.features:
        pytest.skip("this device does not rasterize into 4 samples a pixel")
    config = {"size": (24, 20), "depth_complexity": 5, "slant": 0.3, "layout": "random", "seed": 3}
    plain, sampled = (generate(SceneConfig(**config, **more)) for more in ({}, {"msaa": 4, "coverage": coverage}))
    with shown(device, sampled) as on:
        found, image = recorded(capture(device, on.scene_buffer, on.canvas), plain), on.truth.image(ALL)
    assert (found.coverage != 15).any() and found.coverage.max() == 15
    with shown(device, generate(scene_of(tmp_path, found, msaa=4, coverage=coverage))) as on:
        np.testing.assert_allclose(on.truth.image(ALL), image, atol=1e-9)
        np.testing.assert_allclose(on.render(catalog()["ab-ll"].variant({})), image, atol=EXACT_ERROR)
    assert samples_of(tmp_path / "recorded.npz") == 4


def faults(scene):
    return [what for _, what in kind_of(scene).faults(scene)]


def test_what_masks_cannot_be_is_refused_in_a_line(tmp_path):
    unmasked = random_recording(4)
    unmasked = Recording(unmasked.viewport, unmasked.pixel, unmasked.depth, unmasked.rgba)
    assert any("has no array coverage" in what for what in faults(scene_of(tmp_path, unmasked, msaa=4)))
    eight = random_recording(8)
    with pytest.raises(UsageError, match=r"coverage of fragment \d+ is \d+; allowed with msaa 2: 1 to 3"):
        generate(scene_of(tmp_path, eight, msaa=2))
    eight.coverage[7] = 0
    with pytest.raises(UsageError, match="coverage of fragment 7 is 0; allowed: a bit for each sample"):
        generate(scene_of(tmp_path, eight, msaa=8))


def test_opaque_parts_are_stored_in_several_samples():
    """A depth buffer of one sample would hide whole pixels of fragments by their middles."""
    mesh = {"kind": "mesh", "file": str(configs_dir() / "meshes" / "knot.obj"), "size": (16, 16), "depth_complexity": 0,
            "alpha": (1.0, 1.0), "msaa": 4}
    with pytest.raises(UsageError, match=r"msaa: 4 with opaque triangles .*; allowed: with opaque store"):
        generate(SceneConfig(**mesh))
    assert len(generate(SceneConfig(**mesh, opaque="store")))


def test_several_samples_go_with_transparency_alone():
    effect = SceneConfig(size=(8, 8), depth_complexity=2, msaa=4, effect="layers")
    assert faults(effect) == ["msaa 4 with effect layers; allowed: one of them"]
    single = SceneConfig(size=(8, 8), depth_complexity=2, coverage="alpha")
    assert faults(single) == ["coverage alpha has no use with one sample a pixel; allowed: with msaa 2 | 4 | 8"]


FLAT = ({"layout": "block", "pixel_density": 0.6}, {"layout": "random", "quad_size": (7, 5)},
        {"fragment_probability": 0.5},
        {"kind": "histogram", "pixels": (20, 30, 0, 60, 22, 11), "depth_complexity": 0, "order": "random"})


@pytest.mark.parametrize("keys", FLAT, ids=lambda keys: ", ".join(map(str, keys.values())))
def test_rectangles_of_whole_pixels_have_one_fragment_in_each_and_the_image_of_one_sample(keys, device):
    """On any device, whatever samples it has: no diagonal shows, and no method loses a fragment to it."""
    keys = {"size": SIZE, "depth_complexity": 5, **keys} if "kind" not in keys else {"size": (13, 11), **keys}
    with shown(device, generate(SceneConfig(**keys))) as on:
        plain, counts = on.truth.image(ALL), on.truth.counts
    for coverage in COVERAGES:
        scene = SceneConfig(**keys, msaa=8, coverage=coverage)
        with shown(device, generate(scene)) as on:
            assert on.stats.geometry == kind_of(scene).geometry_of(scene)
            assert on.stats.one_sample and counts.sum() == on.stats.F and on.truth.edge_pixels == 0
            for method in ("ab-ll", "lin-post", "kplus-array"):
                variant = variant_of(catalog()[method])
                assert on.errors(variant, on.render(variant))["max_abs_error"] <= EXACT_ERROR, (coverage, method)
            colour = on.truth.image(ALL)
        np.testing.assert_allclose(colour, plain, atol=0.02)  # colours have six bits beside a mask
