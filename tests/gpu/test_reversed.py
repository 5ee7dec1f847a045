"""Depth ranges of meshes: where float32 window depths lose the order of what is far away, and reversed ones keep it."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config import load, stress_configs
from mfr_bench.errors import UsageError
from mfr_bench.gpu.capture import capture
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Promise
from mfr_bench.oracle.listed import recorded
from mfr_bench.plan import expand, judge
from mfr_bench.scene import generate

CELLS = expand(load(str(stress_configs()["perspective"]), catalog(), "smoke")[0], catalog())
EXACT = {m.family: m for m in catalog().values()
         if m.guarantee.startswith("exact") and "forward" not in m.variant({}).asks}


def scene(depth_range, gap):
    return next(cell.scene for cell in CELLS
                if (cell.scene.depth_range, cell.scene.file) == (depth_range, f"meshes/far-{gap}.obj"))


def mirrored(depth):
    """A window depth as shaders of reversed scenes read it."""
    bits = np.float32([1.0, 2.0**-24]).view(np.uint32).sum(dtype=np.uint32) - np.float32(depth).view(np.uint32)
    return bits.view(np.float32)


def test_the_mirror_image_grows_from_the_eye_and_loses_nothing():
    depth = np.float32([1.0, 1 - 2.0**-24, 0.5, 2.0**-10, np.nextafter(np.float32(2.0**-20), 1), 2.0**-20, 2.0**-24])
    found = mirrored(depth)
    assert (np.diff(found) > 0).all() and found[0] == 2.0**-24 and found[-1] == 1.0
    np.testing.assert_array_equal(mirrored(found), depth)


@pytest.mark.parametrize(("depth_range", "apart"), [("half", ["1"]), ("whole", ["1", "0.1"]),
                                                    ("reversed", ["1", "0.1", "0.01", "0.001"])])
def test_layers_far_away_stay_apart_as_long_as_floats_do(device, depth_range, apart):
    for gap in ("1", "0.1", "0.01", "0.001"):
        with shown(device, generate(scene(depth_range, gap))) as on:
            assert on.stats.n == 8
            assert (not on.truth.answer(Promise()).tied.any()) is (gap in apart), gap


def test_a_device_gives_reversed_scenes_the_same_image_as_others(device):
    images = []
    for depth_range in ("half", "reversed"):
        with shown(device, generate(scene(depth_range, "1"))) as on:
            images.append(on.truth.image(Promise()))
    np.testing.assert_array_equal(*images)


@pytest.mark.parametrize("method", EXACT.values(), ids=lambda method: method.id)
def test_methods_that_compare_in_shaders_are_exact(device, method):
    emulated = any(param.name == "atomic64" for param in method.params)
    variant = method.variant({"atomic64": "emulated"} if emulated else {})
    with shown(device, generate(scene("reversed", "0.001"))) as on:
        if "flat" in variant.asks:
            return
        assert on.errors(variant, on.render(variant))["max_abs_error"] <= 1e-4


@pytest.mark.parametrize("name", ["peel-f2b", "zbuffer"])
def test_methods_that_test_against_a_depth_buffer_are_unsupported(device, name):
    cell = replace(CELLS[0], method=name, params=catalog()[name].complete({}), scene=scene("reversed", "1"))
    with shown(device, generate(cell.scene)) as on:
        assert judge(cell, catalog(), on.stats, None) == (
            "unsupported", "needs depths that grow from the eye, since a pass tests against a depth buffer")
    forward = replace(cell, scene=scene("half", "1"))
    with shown(device, generate(forward.scene)) as on:
        assert judge(forward, catalog(), on.stats, None) is None


def test_a_recording_of_a_reversed_scene_has_depths_that_grow_from_the_eye(device):
    with shown(device, generate(scene("reversed", "0.01"))) as on:
        found = recorded(capture(device, on.scene_buffer, on.canvas))
    here = (found.pixel == found.pixel[0]).all(axis=1)
    assert here.sum() == 8
    assert (np.diff(found.depth[here]) > 0).all()
    assert found.depth.min() > 0 and found.depth.max() <= 1


def test_opaque_parts_have_to_be_stored(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "m.yaml").write_text("name: m\nscene: {kind: mesh, file: a.obj, size: [8, 8], depth_range: reversed}\n"
                                     "methods: [ab-array]\n")
    with pytest.raises(UsageError, match="opaque: depth with reversed depths; allowed: opaque: store"):
        load(str(tmp_path / "m.yaml"), catalog())
