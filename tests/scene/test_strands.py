"""`kind: strands`: hair that is generated or read, widened on the screen; the oracle and methods see the same."""

import hashlib

import numpy as np
import pytest

from mfr_bench.config import load
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.errors import UsageError
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.plan import expand, expected_stats
from mfr_bench.scene import generate
from mfr_bench.scene.kinds.mesh import Fit, View
from mfr_bench.scene.polylines import read_polylines
from mfr_bench.scene.strands import polylines

BOX = View(fit=Fit(box=(0, 0, 16, 16)))  # a unit is a pixel of a viewport of 16 x 16


def scene(**keys):
    return SceneConfig(kind="strands", depth_complexity=0, **({"size": (64, 48), "strands": 60} | keys))


def own(tmp_path, text, **keys):
    path = tmp_path / "a.obj"
    path.write_text(text)
    return scene(size=(16, 16), file=str(path), view=BOX, strands=2000, alpha=(0.5, 0.5), **keys)


def test_generated_hair_is_the_same_for_a_seed_and_lies_outside_the_head():
    one, again, other = (polylines(scene(seed=seed)) for seed in (1, 1, 2))
    assert (one.points == again.points).all() and not (one.points == other.points).all()
    assert one.points.shape == (60 * 17, 3)
    assert (np.linalg.norm(one.points, axis=1) >= 1 - 1e-12).all()
    assert hashlib.sha256(np.round(one.points, 9).tobytes()).hexdigest()[:8] == "27d1fa0b"


def test_pieces_of_a_strand_share_their_ends_and_a_colour():
    made = generate(scene(order="file"))
    assert len(made) == 60 * 16
    np.testing.assert_array_equal(made.position[:15, 2:], made.position[1:16, :2])
    assert len(np.unique(made.rgba[:16], axis=0)) == 1


@pytest.mark.parametrize("width", [1.0, 3.0, 5.0])
def test_a_straight_strand_covers_its_width_in_pixels(tmp_path, device, width):
    """Along x, through the middle of a row of pixels; the end caps are cut at its points."""
    with shown(device, generate(own(tmp_path, "v 2 8.5 0\nv 9 8.5 0\nv 14 8.5 0\nl 1 2 3\n", width=width))) as on:
        counts = on.truth.counts
    assert counts.max() == 1  # the ends that pieces share are covered once
    assert counts.sum() == 12 * width


def test_a_strand_below_a_pixel_is_a_sliver_or_gives_its_width_to_its_alpha(tmp_path, device):
    text = "v 2 8.9 0\nv 14 8.9 0\nl 1 2\n"  # a tenth of a pixel below the edge, off all middles
    sliver = generate(own(tmp_path, text, width=0.2, thin="sliver"))
    with shown(device, sliver) as on:
        assert on.stats.F == 0
    wide = generate(own(tmp_path, text, width=0.2, thin="alpha"))
    with shown(device, wide) as on:
        assert on.stats.F == 12
    assert sliver.rgba[0, 3] == 128 and wide.rgba[0, 3] == round(0.1 * 255)


@pytest.mark.parametrize("view", [View(), View(projection="perspective", eye=(0, 0, 1.5), target=(0, 0, 0))])
def test_the_plan_the_oracle_and_methods_see_one_scene(device, view):
    config = scene(view=view)
    expected = expected_stats(config)
    with shown(device, generate(config)) as on:
        assert pytest.approx(expected.F, rel=0.35) == on.stats.F
        assert on.stats.primitives == expected.primitives
        for name in ("ab-array", "ab-ll", "kplus-array", "peel-dual"):
            method = catalog()[name].variant({})
            assert on.errors(method, on.render(method))["max_abs_error"] <= 1e-4, name


def test_a_file_of_arrays_and_lines_of_an_obj_are_the_same(tmp_path):
    points = [[0, 0, 0], [1, 2, 3], [4, 5, 6], [7, 8, 9], [1, 1, 1]]
    np.savez(tmp_path / "a.npz", points=np.float32(points), lengths=np.int32([3, 2]))
    (tmp_path / "a.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in points) + "# c\nl 1 2/1 3 # d\nl -2 -1\n")
    one, other = (read_polylines(str(tmp_path / f"a.{ending}")) for ending in ("npz", "obj"))
    np.testing.assert_array_equal(one.points, other.points)
    assert one.lengths.tolist() == other.lengths.tolist() == [3, 2]
    assert [values.tolist() for values in one.pieces] == [[0, 1, 3], [0, 0, 1]]


@pytest.mark.parametrize(("text", "line"), [
    ("v 0 0 0\nv 1 1 1\n", "it has no strands; allowed: a file of strands"),
    ("v 0 0 0\nl 1 2\n", "line 2: vertex 2 of 1; allowed: v with three numbers, l with numbers of vertices before it"),
    ("v 0 0\n", "line 1: a vertex of fewer than three numbers"), ("v 0 0 x\n", "line 1: could not convert"),
    ("v 0 0 0\nl 1\n", "strand 0 has 1 points; allowed: 2 or more"),
    ("v 0 0 nan\nv 0 0 0\nl 1 2\n", "point 0 is no number; allowed: finite coordinates")])
def test_a_bad_obj_is_one_line(tmp_path, text, line):
    with pytest.raises(UsageError) as error:
        generate(own(tmp_path, text))
    assert len(error.value.lines) == 1 and error.value.lines[0].startswith(f"{tmp_path / 'a.obj'}: {line}")


@pytest.mark.parametrize(("arrays", "line"), [
    ({"points": np.zeros((2, 3))}, "the array lengths is missing; allowed: points and lengths"),
    ({"points": np.zeros((2, 2)), "lengths": [2]}, "points is float64 (2, 2); allowed: numbers (n, 3)"),
    ({"points": np.zeros((2, 3)), "lengths": [3]},
     "lengths is int64 (1,) with the sum 3; allowed: whole numbers (m,) that add up to the 2 points")])
def test_a_bad_npz_is_one_line(tmp_path, arrays, line):
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(UsageError) as error:
        read_polylines(str(tmp_path / "a.npz"))
    assert error.value.lines == [f"{tmp_path / 'a.npz'}: {line}"]


@pytest.mark.parametrize(("keys", "line"), [
    ("file: a.txt", "a.txt holds no strands; allowed: a file that ends in .npz or .obj"),
    ("file: b.obj", "b.obj: no such file; allowed: a file of strands"),
    ("file: a.obj, strands: 3", "strands beside a file, which has its own; allowed: one of them"),
    ("width: 0", "allowed: pixels above 0, up to 256"), ("order: object", "order 'object' has no use in kind strands"),
    ("view: {field: 30}", "eye and field have no use in an orthographic view")])
def test_a_bad_key_is_one_line(tmp_path, keys, line):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 1 1\nl 1 2\n")
    (tmp_path / "s.yaml").write_text(f"name: s\nscene: {{kind: strands, size: [8, 8], {keys}}}\nmethods: [ab-array]\n")
    with pytest.raises(UsageError) as error:
        expand(load(str(tmp_path / "s.yaml"), catalog())[0], catalog())
    assert len(error.value.lines) == 1 and line in error.value.lines[0]


def test_a_record_has_the_keys_of_strands_and_those_of_a_file(tmp_path):
    grown, read = scene().as_dict(), own(tmp_path, "v 0 0 0\nv 1 1 1\nl 1 2\n").as_dict()
    assert grown["strands"] == 60 and "files" not in grown and "layout" not in grown
    assert read["files"] == ["a.obj"] and str(tmp_path) not in str(read["digest"])
