"""Scenes of `kind: mesh`: what the view shows, in which order, with which opacities; bad keys in a line each."""

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.config import load
from mfr_bench.errors import UsageError
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.plan import expand, expected_stats
from mfr_bench.scene import generate
from mfr_bench.scene.kinds import kind_of
from mfr_bench.scene.kinds.mesh import Transform, View
from mfr_bench.scene.mesh import matrix_of

MATERIALS = "newmtl red\nKd 1 0 0\nd 0.25\nnewmtl wall\nKd 0 1 0\n"
# Two translucent squares at z = 1 and z = 3, an opaque one between them over the left half, as two objects.
SQUARES = """\
mtllib a.mtl
o near
v 0 0 3
v 4 0 3
v 4 4 3
v 0 4 3
usemtl red
f 1 2 3 4
o others
v 0 0 1
v 4 0 1
v 4 4 1
v 0 4 1
f 5 6 7 8
v 0 0 2
v 2 0 2
v 2 4 2
v 0 4 2
usemtl wall
f 9 10 11 12
"""
BOX = "fit: {box: [0, 0, 4, 4]}"
CONFIG = "name: m\nscene: {kind: mesh, file: a.obj, size: [8, 8], alpha: material%s}\nmethods: [ab-array]\n"


@pytest.fixture
def scene_of(tmp_path):
    """scene_of(', faces: front') -> the scene of a config with these keys."""
    (tmp_path / "a.obj").write_text(SQUARES)
    (tmp_path / "a.mtl").write_text(MATERIALS)

    def made(keys=f", view: {{{BOX}}}", config=CONFIG):
        (tmp_path / "m.yaml").write_text(config % keys)
        return expand(load(str(tmp_path / "m.yaml"), catalog())[0], catalog())[0].scene
    return made


def test_a_box_is_shown_exactly_and_what_is_behind_something_opaque_never_counts(scene_of, device):
    with shown(device, generate(scene_of())) as on:
        counts = on.truth.counts
        image = on.render(catalog()["ab-array"].variant({}))
    assert (counts[:, :4] == 1).all() and (counts[:, 4:] == 2).all()
    alpha = round(0.25 * 255) / 255
    np.testing.assert_allclose(image[0, 0], [alpha, 0, 0, alpha], atol=1e-6)
    np.testing.assert_allclose(image[0, 7, 3], 1 - (1 - alpha) ** 2, atol=1e-6)


def test_opaque_triangles_may_be_stored_like_all_others(scene_of, device):
    scene = scene_of(f", opaque: store, view: {{{BOX}}}")
    with shown(device, generate(scene)) as on:
        assert (on.truth.counts[:, :4] == 3).all() and on.stats.n == 3


@pytest.mark.parametrize(("keys", "refused"), [("", True), (", opaque: store", False), (", alpha: 0.5", False)])
def test_opaque_triangles_in_several_samples_a_pixel_are_refused_before_they_are_drawn(scene_of, keys, refused):
    """The process that measures ended over them, and every cell of the scene was a crash."""
    scene = scene_of(f"{keys}, msaa: 4", CONFIG.replace(", alpha: material", "") if "alpha" in keys else CONFIG)
    lacks = kind_of(scene).lacks(scene)
    assert ("scene.opaque: store" in lacks) if refused else lacks is None


@pytest.mark.parametrize(("order", "expected"), [("file", [0, 0, 1, 1]), ("object", [0, 0, 1, 1]),
                                                 ("front_to_back", [0, 0, 1, 1]), ("back_to_front", [1, 1, 0, 0])])
def test_orders_of_submission(scene_of, order, expected):
    assert generate(scene_of(f", order: {order}")).object.tolist() == expected


def test_a_random_order_is_the_same_for_a_seed(scene_of):
    one, again, other = (generate(scene_of(f", order: random, seed: {seed}")) for seed in (1, 1, 7))
    assert (one.position == again.position).all() and sorted(one.object) == sorted(other.object)


def test_sides_are_culled(scene_of):
    assert len(generate(scene_of(", faces: front"))) == 4
    assert len(generate(scene_of(", faces: back"))) == 0
    assert len(generate(scene_of(", faces: back, view: {direction: +z}"))) == 4


def test_opacities_of_the_config_replace_the_file_s(scene_of):
    config = CONFIG.replace("material", "[0.2, 0.4]")
    alphas = generate(scene_of(config=config)).rgba[:, 3]
    assert len(alphas) == 6 and alphas.min() >= 51 and alphas.max() <= 102


def test_a_camera_that_goes_around_shows_other_sides(scene_of, device):
    scene = scene_of(", animate: true, opaque: store")
    first, quarter = generate(scene, 0), generate(scene, 2)
    assert not np.allclose(first.position, quarter.position)
    assert np.allclose(first.position, generate(scene, 8).position)


def test_several_files_with_transforms(tmp_path, scene_of):
    scene = scene_of()
    files = (Transform(file="a.obj"), Transform(file="a.obj", scale=2.0, rotate=(0, 0, 90), translate=(1, 2, 3)))
    both = generate(replace(scene, file=None, files=files, opaque="store", view=View()))
    assert len(both) == 12 and sorted(set(both.object)) == [0, 1, 2, 3]
    moved = matrix_of(files[1]) @ [1, 0, 0, 1]
    np.testing.assert_allclose(moved, [1, 4, 3, 1], atol=1e-12)


def test_a_record_names_the_file_and_its_contents_but_no_folder(scene_of, tmp_path):
    scene = scene_of()
    record = scene.as_dict()
    assert record["files"] == ["a.obj"] and str(tmp_path) not in str(record)
    assert not {"depth_complexity", "layout", "depth_range", "shading"} & record.keys()  # at their defaults, or unused
    (tmp_path / "a.obj").write_text(SQUARES + "\n# another\n")
    assert scene_of().as_dict()["digest"] != record["digest"]


def test_a_plan_expects_about_what_the_device_finds(device):
    scene = expand(load("meshes", catalog(), "smoke")[0], catalog())[0].scene
    expected = expected_stats(scene)
    with shown(device, generate(scene)) as on:
        found = on.stats
    assert expected.primitives == found.primitives
    assert 0.5 * found.F < expected.F < 2 * found.F
    assert 0.5 < sum(expected.histogram[1:]) / sum(found.histogram[1:]) < 2


BAD = [
    ("file: a.obj", "file: gone.obj", "gone.obj: no such file; allowed: an OBJ, PLY, STL, GLB or glTF file"),
    ("file: a.obj, ", "", "no file; allowed: file, or files"),
    ("alpha: material", "alpha: solid", "'solid' is not allowed"),
    ("size: [8, 8]", "size: [8, 8], order: sideways", "'sideways' is not allowed"),
    ("size: [8, 8]", "size: [8, 8], view: {direction: up}", "'up' is not allowed; allowed: -z | +z"),
    ("size: [8, 8]", "size: [8, 8], view: {eye: [0, 0, 9]}", "an eye without a target"),
    ("size: [8, 8]", "size: [8, 8], view: {eye: [0, 0, 9], target: [0, 0, 0]}", "no use in an orthographic view"),
    ("size: [8, 8]", "size: [8, 8], view: {projection: perspective, fit: {box: [0, 0, 1, 1]}}", "a box has no use"),
    ("size: [8, 8]", "size: [8, 8], view: {fit: {box: [1, 0, 1, 1]}}", "an empty box"),
    ("size: [8, 8]", "size: [8, 8], depth_complexity: 9", "depth_complexity has no use in kind mesh"),
    ("size: [8, 8]", "size: [8, 8], pixel_density: 0.5", "pixel_density has no use in kind mesh"),
    ("size: [8, 8]", "size: [8, 8], layout: tiles", "layout has no use in kind mesh"),
    ("size: [8, 8]", "size: [8, 8], folder: /tmp", "unknown key"),
    ("kind: mesh, file: a.obj", "depth_complexity: 4, kind: quads", "alpha 'material' has no use"),
]


@pytest.mark.parametrize(("right", "wrong", "said"), BAD, ids=[said for *_, said in BAD])
def test_bad_keys_are_a_line_each(scene_of, right, wrong, said):
    with pytest.raises(UsageError) as error:
        scene_of("", CONFIG.replace(right, wrong))
    line, = error.value.lines
    assert said in line and "m.yaml:2" in line


def test_an_eye_that_sees_nothing_is_one_line(scene_of):
    scene = scene_of(", view: {projection: perspective, eye: [0, 0, 9], target: [0, 0, 20]}")
    with pytest.raises(UsageError, match=r"scene\.view: all of the mesh is behind the eye"):
        generate(scene)
