"""Effects on closed objects: by hand for two boxes and two spheres, and every method against the models."""

import json
import math
from contextlib import ExitStack

import numpy as np
import pytest

from mfr_bench.config import load
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.effects import EFFECTS, OPERATIONS, Settings
from mfr_bench.effects.word import colours_of, fronts_of, objects_of, packed, words
from mfr_bench.errors import UsageError
from mfr_bench.gpu.capture import capture
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.oracle.listed import recorded
from mfr_bench.plan import expand
from mfr_bench.scene import generate
from mfr_bench.scene.kinds import kind_of
from mfr_bench.scene.mesh import camera_of, faces_of
from mfr_bench.scene.parts import with_effect
from mfr_bench.scene.pieces import Pieces
from mfr_bench.store.status import EXACT_ERROR

from .solids import ball, box, write

ON_OBJECTS = [name for name, effect in EFFECTS.items() if effect.needs != "nothing"]
A, B = ((2, 2, 0), (10, 10, 4)), ((6, 6, 2), (14, 14, 8))  # overlap in x and y from 6 to 10, in z from 2 to 4
VIEW = {"direction": "-z", "fit": {"box": [0, 0, 16, 16]}}
RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def config_of(path, **keys):
    """The scene of a config of the file: a pixel for each unit of x and y, seen from above, the larger z the nearer."""
    scene = {"kind": "mesh", "file": path.name, "size": [16, 16], "alpha": "material", "order": "random",
             "opaque": "store", "depth_range": "whole", "view": VIEW} | keys
    return loaded(path.with_suffix(".yaml"), scene)


def loaded(path, scene):
    """The scene of a config with these keys, written to the path."""
    path.write_text(json.dumps({"name": "solids", "scene": scene, "methods": ["ab-ll"]}))
    return expand(load(str(path), catalog())[0], catalog())[0].scene


@pytest.fixture(scope="module")
def boxes(tmp_path_factory):
    return write(tmp_path_factory.mktemp("solids") / "boxes.obj", box(*A), box(*B))


def image_of(device, config):
    with shown(device, generate(config)) as on:
        variant = catalog()["ab-ll"].variant({})
        image = on.render(variant)
        errors = on.errors(variant, image)
    assert errors["max_abs_error"] <= EXACT_ERROR and not errors["tied_pixels"]
    return image


def depth_of(config, z):
    """The window depth of a height above the plane, as the camera maps it to the whole range."""
    camera = camera_of(config, faces_of(config).position, 0)
    return 2.0**-10 + (1 - 2.0**-9) * (-z - camera.near) / (camera.far - camera.near)


def length_of(config, units):
    """The length of window depth that so many units of z have."""
    return abs(depth_of(config, units) - depth_of(config, 0))


def expected(alone, other, both):
    """float64 (16, 16, 4): the colours of A alone, of B alone and of both; None is transparent black."""
    a, b = (np.zeros((16, 16), dtype=bool) for _ in range(2))
    a[2:10, 2:10], b[6:14, 6:14] = True, True
    image = np.zeros((16, 16, 4))
    for where, value in ((a & ~b, alone), (b & ~a, other), (a & b, both)):
        image[where] = 0 if value is None else [*np.broadcast_to(value, 3), 1]
    return image


def test_the_thickness_of_two_boxes_is_that_of_their_union(device, boxes):
    config = config_of(boxes, effect="thickness")
    wanted = expected(*(length_of(config, units) for units in (4, 6, 8)))
    np.testing.assert_allclose(image_of(device, config), wanted, atol=1e-5)


def test_two_boxes_absorb_light_by_the_length_within_each(device, boxes):
    """A lets red through, B blue: green loses by both."""
    config = config_of(boxes, effect="translucency", absorption=3.0)
    a, b = (3.0 * (128 / 255) * length_of(config, units) for units in (4, 6))
    wanted = expected(np.exp([0, -a, -a]), np.exp([-b, -b, 0]), np.exp([-b, -a - b, -a]))
    np.testing.assert_allclose(image_of(device, config), wanted, atol=1e-5)


def test_two_boxes_collide_in_so_many_pixels_along_so_much_depth(device, boxes):
    config = config_of(boxes, effect="collision")
    image = image_of(device, config)
    np.testing.assert_allclose(image, expected(0.2, 0.2, (1, length_of(config, 2), 1 / 16)), atol=1e-5)
    assert np.count_nonzero(image[..., 0] == 1) == 4 * 4


@pytest.mark.parametrize(("operation", "seen"), [("union", (RED, BLUE, BLUE)), ("intersection", (None, None, RED)),
                                                 ("difference", (RED, None, BLUE))])
def test_two_boxes_make_a_solid_whose_first_face_is_seen(device, boxes, operation, seen):
    """The top of A is within the overlap; what B cuts out of A ends at the bottom of B."""
    image = image_of(device, config_of(boxes, effect="csg", operation=operation))
    np.testing.assert_allclose(image, expected(*seen), atol=1e-6)


@pytest.mark.parametrize(("around", "error", "rim"), [(24, 0.05, 0.8), (96, 0.004, 0.1)])
def test_spheres_come_nearer_to_the_analytic_answer_the_finer_they_are(device, tmp_path, around, error, rim):
    """Two of radius 6, their middles 6 apart along the view: the overlap has radius √27, of which a rim may be lost.

    `rim` is its width in pixels. Faces lie within R(1 - cos δ/√2) of the sphere, where δ is the angle between corners.
    """
    solids = (ball((8, 8, z), 6, around, around // 2) for z in (6, 12))
    config = config_of(write(tmp_path / "balls.obj", *solids), effect="collision", size=[64, 64])
    image = image_of(device, config)
    across = (np.arange(64) + 0.5) / 4 - 8
    squared = across[:, None] ** 2 + across ** 2
    length = np.maximum(2 * np.sqrt(np.maximum(36 - squared, 0)) - 6, 0) * length_of(config, 1)
    assert np.abs(image[..., 1] - length)[squared < 25].max() <= error
    found, analytic = np.count_nonzero(image[..., 0] == 1), np.count_nonzero(length)
    assert abs(found - analytic) <= rim * 2 * math.pi * math.sqrt(27) * 4


def variant_of(method):
    return method.variant({"atomic64": "emulated"} if method.param("atomic64") else {})


EXACT = [m for m in catalog().values() if variant_of(m).hands_on and variant_of(m).guarantee.startswith("exact")]


@pytest.fixture(scope="module")
def stages(device, tmp_path_factory):
    """Two balls and a box that meet, under each effect: the keys of a scene, and the scene on the device."""
    solids = (ball((7, 7.3, 6), 5, 9, 7), ball((9.2, 8.1, 8), 4, 8, 6), box((3.1, 6.2, 3), (13.3, 8.4, 9.5)))
    path = write(tmp_path_factory.mktemp("solids") / "some.obj", *solids,
                 colours=((1, .4, 0), (0, .6, 1), (.3, .9, .1)))
    chosen = [{"effect": name} for name in ON_OBJECTS] + [{"effect": "csg", "operation": o} for o in OPERATIONS[1:]]
    with ExitStack() as stack:
        yield [(keys, stack.enter_context(shown(device, generate(config_of(path, **keys))))) for keys in chosen]


@pytest.mark.parametrize("method", EXACT, ids=lambda m: m.id)
def test_every_exact_method_that_hands_fragments_on_agrees_with_the_models(method, stages, device):
    variant, stats = variant_of(method), stages[0][1].stats
    lacking = [*(set(variant.needs) - device.features), *(f for f in variant.asks if not getattr(stats, f))]
    if lacking:
        pytest.skip(f"needs {', '.join(lacking)}")
    for keys, on in stages:
        found = on.errors(variant, on.render(variant))
        assert found["max_abs_error"] <= EXACT_ERROR and not found["tied_pixels"], keys


@pytest.mark.parametrize("chosen", [{"k": 2}, {"k": 3, "payload": "rgba16f"}, {"resolve": "compute"}], ids=str)
def test_a_k_buffer_is_right_of_what_it_keeps(chosen, stages):
    for keys, on in stages:
        variant = catalog()["kplus-array"].variant(chosen)
        assert on.errors(variant, on.render(variant))["max_abs_error"] <= EXACT_ERROR, keys


def test_a_recording_with_objects_and_sides_shows_what_its_mesh_does(device, boxes):
    mesh = config_of(boxes, effect="collision")
    with shown(device, generate(config_of(boxes))) as on:
        recording = recorded(capture(device, on.scene_buffer, on.canvas))
    (boxes.parent / "boxes.npz").write_bytes(recording.packed())
    scene = {"kind": "fragments", "file": "boxes.npz", "size": [16, 16], "order": "file", "effect": "collision"}
    np.testing.assert_allclose(image_of(device, loaded(boxes.with_name("recorded.yaml"), scene)),
                               image_of(device, mesh), atol=1e-6)


def test_words_hold_what_was_put_in():
    rgba = np.uint8([[0, 255, 85, 128], [255, 0, 170, 7]])
    found = packed(rgba, np.int32([3, 31]), np.array([True, False]))
    assert found.shape == (2, 4) and found.dtype == np.uint8
    np.testing.assert_array_equal(objects_of(found), np.uint32([1 << 3, 1 << 31]))
    np.testing.assert_array_equal(fronts_of(found), [True, False])
    np.testing.assert_allclose(colours_of(found), [[0, 1, 1 / 3], [1, 0, 2 / 3]])
    np.testing.assert_array_equal(words(found) >> 24, rgba[:, 3])


@pytest.mark.parametrize(("keys", "said"), [
    ({"effect": "csg", "opaque": "depth"}, "both sides of all faces"),
    ({"effect": "thickness", "faces": "front"}, "both sides of all faces"),
    ({"effect": "collision", "view": {"projection": "perspective"}}, "differences of depth"),
    ({"effect": "thickness", "depth_range": "reversed"}, "differences of depth"),
    ({"effect": "thickness", "operation": "difference"}, "operation has no use with effect thickness"),
    ({"absorption": 2.0}, "absorption has no use with effect transparency"),
])
def test_what_an_effect_cannot_do_is_said(boxes, keys, said):
    with pytest.raises(UsageError, match=said):
        config_of(boxes, **keys)


@pytest.mark.parametrize("name", ON_OBJECTS)
def test_scenes_without_objects_are_refused(name):
    config = SceneConfig(size=(8, 8), depth_complexity=2, effect=name)
    assert any("closed objects" in what for _, what in kind_of(config).faults(config))


def test_more_objects_than_a_word_tells_apart_are_refused(tmp_path):
    solids = [box((i, 0, 0), (i + 1, 1, 1)) for i in range(33)]
    path = write(tmp_path / "many.obj", *solids, colours=[RED] * 33)
    with pytest.raises(UsageError, match="33 objects; allowed: at most 32"):
        generate(config_of(path, effect="csg"))
    assert generate(config_of(path, effect="thickness")).effect == Settings("thickness")


def test_a_recording_without_sides_is_refused():
    made = Pieces((2, 2), np.int32([[0, 0, 1, 1]]), np.float32([0.5]), np.uint8([[9, 9, 9, 9]]), 1.0, 1)
    with pytest.raises(UsageError, match="a recording with object and front"):
        with_effect(made, Settings("csg"))
