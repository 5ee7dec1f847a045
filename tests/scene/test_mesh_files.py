"""Mesh files: every face in file order, with the colours and opacities that the formats define; bad ones in a line."""

import numpy as np
import pytest
from PIL import Image

from mfr_bench.errors import UsageError
from mfr_bench.scene.meshes import library
from mfr_bench.scene.meshes.read import read_mesh

from .mesh_files import TRIANGLE, ply, stl, surface, write_glb

MATERIALS = "newmtl red\nKd 1 0 0\nd 0.25\nnewmtl blue\nKd 0 0 1\nTr 0.25\n"
CORNERS = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def obj(folder, text, materials=MATERIALS):
    (folder / "m.mtl").write_text(materials)
    (folder / "a.obj").write_text(text)
    return read_mesh(folder / "a.obj")


def test_d_and_tr_are_opacities_and_materials_in_turns_keep_the_order_of_the_file(tmp_path):
    found = obj(tmp_path, f"mtllib m.mtl\n{CORNERS}usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\nusemtl red\nf 1 2 4\n")
    assert found.rgba.tolist() == [[255, 0, 0, 64], [0, 0, 255, 191], [255, 0, 0, 64]]
    assert found.position[1].tolist() == [[0, 0, 0], [1, 1, 0], [0, 1, 0]]


def test_an_opacity_with_halo_is_an_opacity(tmp_path):
    """Readers refuse the model, or take it for invisible (findings/mtl_dissolve_halo.sh)."""
    materials = "newmtl red\nKd 1 0 0\nd -halo 0.25\n"
    found = obj(tmp_path, f"mtllib m.mtl\n{CORNERS}usemtl red\nf 1 2 3\n", materials)
    assert found.rgba.tolist() == [[255, 0, 0, 64]]


def test_negative_indices_count_backwards_from_the_face(tmp_path):
    found = obj(tmp_path, f"{CORNERS}f -4 -3 -2\nv 9 9 9\nf 1 2 3\n")
    assert found.position[0].tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0]]


def test_polygons_become_triangles_in_place(tmp_path):
    found = obj(tmp_path, f"{CORNERS}v 0.5 2 0\nf 1 2 3 4\nf 1 2 3 5 4\n")
    areas = np.linalg.norm(np.cross(found.position[:, 1] - found.position[:, 0],
                                    found.position[:, 2] - found.position[:, 0]), axis=1) / 2
    assert len(found) == 5
    assert areas[:2].sum() == 1.0 and areas[2:].sum() == 1.5


CONCAVE = [(0, 0, 0), (4, 0, 0), (4, 4, 0), (2, 1, 0), (0, 4, 0)]  # an arrow head, of area 10


@pytest.mark.parametrize("start", range(5))
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("ending", ["obj", "ply"])
def test_concave_polygons_cover_no_more_than_they_are(tmp_path, ending, start, turned):
    """In any plane, from whichever corner the file begins, and with their front where it was."""
    corners = np.roll(np.array(CONCAVE, float), -start, axis=0) @ np.array([[0.6, 0, 0.8], [0, 1, 0], [-0.8, 0, 0.6]])
    corners = corners[::-1] if turned else corners
    if ending == "obj":
        lines = "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
        found = obj(tmp_path, f"{lines}f 1 2 3 4 5\n")
    else:
        (tmp_path / "a.ply").write_text(ply([f"{x} {y} {z}" for x, y, z in corners], ["5 0 1 2 3 4"]))
        found = read_mesh(tmp_path / "a.ply")
    normal = np.cross(found.position[:, 1] - found.position[:, 0], found.position[:, 2] - found.position[:, 0]) / 2
    assert np.linalg.norm(normal, axis=1).sum() == pytest.approx(10)
    assert np.linalg.norm(normal.sum(axis=0)) == pytest.approx(10)
    assert ((normal @ [-0.8, 0, 0.6] < 0) == turned).all()


def test_a_byte_order_mark_hides_no_vertex(tmp_path):
    """Without its first vertex the others would move up, and a face would be another one."""
    text = f"{CORNERS}v 9 9 9\nf 1 2 3\n"
    (tmp_path / "a.obj").write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert read_mesh(tmp_path / "a.obj").position[0].tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0]]


def test_strips_of_a_ply_are_named(tmp_path):
    (tmp_path / "a.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    with pytest.raises(UsageError, match=r"a\.ply: .*its faces are tristrips, which are not read here"):
        read_mesh(tmp_path / "a.ply")


def test_vertices_at_one_place_keep_their_own_colours(tmp_path):
    found = obj(tmp_path, "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 0 0 0 0 0 1\nv 1 0 0 0 0 1\nv 0 1 0 0 0 1\n"
                          "f 1 2 3\nf 4 5 6\n")
    assert found.rgba.tolist() == [[255, 0, 0, 255], [0, 0, 255, 255]]


@pytest.mark.parametrize("ending", ["obj", "stl", "ply"])
def test_duplicate_back_to_back_and_degenerate_faces_stay(tmp_path, ending):
    indices = ((1, 2, 3), (1, 2, 3), (3, 2, 1), (1, 1, 2))
    path = tmp_path / f"a.{ending}"
    if ending == "obj":
        path.write_text(CORNERS + "".join(f"f {a} {b} {c}\n" for a, b, c in indices))
    elif ending == "stl":
        path.write_bytes(stl(*([TRIANGLE[i - 1] for i in face] for face in indices)))
    else:
        path.write_text(ply(["0 0 0", "1 0 0", "0 1 0"], [f"3 {a - 1} {b - 1} {c - 1}" for a, b, c in indices]))
    assert len(read_mesh(path)) == 4


@pytest.mark.parametrize("scale", [1e-8, 1e8])
def test_a_model_of_any_size_keeps_its_shape(tmp_path, scale):
    found = obj(tmp_path, f"v 0 0 0\nv {scale} 0 0\nv 0 {scale} 0\nf 1 2 3\nf 1 2 3\n")
    np.testing.assert_allclose(found.position[1], scale * np.array(TRIANGLE), rtol=1e-6)


def test_lines_beside_faces_are_left_out(tmp_path):
    found = obj(tmp_path, f"mtllib m.mtl\n{CORNERS}usemtl red\nl 1 2\nf 1 2 3\np 1\nf -4 -3 -2\n")
    assert found.rgba.tolist() == [[255, 0, 0, 64]] * 2


def test_faces_of_two_corners_are_left_out(tmp_path):
    found = obj(tmp_path, f"mtllib m.mtl\n{CORNERS}usemtl red\nf 1 2\nf 1 2 3\nf 3\r\nf 2 3 4\n")
    assert len(found) == 2


def test_objects_are_told_apart(tmp_path):
    found = obj(tmp_path, f"mtllib m.mtl\no a\n{CORNERS}usemtl red\nf 1 2 3\nusemtl blue\nf 1 2 4\no b\nf 1 3 4\n")
    assert found.object.tolist() == [0, 0, 1]


def test_a_texture_stands_for_its_mean_colour_and_says_so(tmp_path):
    Image.fromarray(np.uint8([[[0, 100, 200]], [[100, 200, 100]]])).save(tmp_path / "t.png")
    found = obj(tmp_path, f"mtllib m.mtl\n{CORNERS}usemtl t\nf 1 2 3\n", "newmtl t\nKd 1 1 1\nd 0.5\nmap_Kd t.png\n")
    assert found.rgba.tolist() == [[50, 150, 150, 128]]
    assert found.notes == ("a texture is replaced by its mean colour",)
    (tmp_path / "t.png").unlink()
    assert "not there" in read_mesh(tmp_path / "a.obj").notes[0]


def test_alpha_modes_of_gltf(tmp_path):
    materials = [surface(0.5), surface(0.5, alphaMode="OPAQUE"), surface(0.5, alphaMode="MASK", alphaCutoff=0.6),
                 surface(0.5, alphaMode="MASK", alphaCutoff=0.4), surface(0.5, alphaMode="BLEND", doubleSided=True)]
    primitives = [{"position": TRIANGLE, "material": i} for i in range(5)]
    path = write_glb(tmp_path / "a.glb", primitives, materials, [{"mesh": i} for i in range(5)], list(range(5)))
    found = read_mesh(path)
    assert found.rgba[:, 3].tolist() == [255, 255, 255, 128]  # absent, OPAQUE, MASK above its cut-off, BLEND
    assert found.object.tolist() == [0, 1, 3, 4]
    assert found.one_sided.tolist() == [True, True, True, False]


def test_nodes_place_their_meshes_and_a_mirror_keeps_the_front(tmp_path):
    nodes = [{"mesh": 0, "translation": [5, 0, 0]}, {"children": [2], "scale": [2, 2, 2]},
             {"mesh": 0, "rotation": [0, 0, 2**-0.5, 2**-0.5]}, {"mesh": 0, "scale": [-1, 1, 1]}]
    path = write_glb(tmp_path / "a.glb", [{"position": TRIANGLE, "index": [0, 1, 2]}], [], nodes, [0, 1, 3])
    found = read_mesh(path)
    expected = [[[5, 0, 0], [6, 0, 0], [5, 1, 0]], [[0, 0, 0], [0, 2, 0], [-2, 0, 0]],
                [[0, 0, 0], [0, 1, 0], [-1, 0, 0]]]
    np.testing.assert_allclose(found.position, expected, atol=1e-7)
    normals = np.cross(found.position[:, 1] - found.position[:, 0], found.position[:, 2] - found.position[:, 0])
    assert (normals[:, 2] > 0).all()


@pytest.mark.parametrize(("mode", "faces"), [(4, [[0, 1, 2]]), (5, [[0, 1, 2], [1, 3, 2]]), (6, [[0, 1, 2], [0, 2, 3]]),
                                             (1, [])])
def test_lists_strips_and_fans(tmp_path, mode, faces):
    square = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    path = write_glb(tmp_path / "a.glb", [{"position": square, "index": [0, 1, 2, 3], "mode": mode},
                                          {"position": TRIANGLE}], [], [{"mesh": 0}, {"mesh": 1}], [0, 1])
    assert read_mesh(path).position[:-1].tolist() == [[square[i] for i in face] for face in faces]


def test_vertex_colours_of_gltf_are_meant_and_multiplied(tmp_path):
    path = write_glb(tmp_path / "a.glb", [{"position": TRIANGLE, "colour": [[1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 0.1]],
                                           "material": 0}], [surface(0.5, alphaMode="BLEND")], [{"mesh": 0}], [0])
    assert read_mesh(path).rgba.tolist() == [[255, 0, 0, round(255 * 0.35)]]


def test_ply_keeps_polygons_in_order_and_takes_colours_of_faces_or_vertices(tmp_path):
    path = tmp_path / "a.ply"
    rgb = ("uchar red", "uchar green", "uchar blue")
    path.write_text(ply(["0 0 0", "1 0 0", "1 1 0", "0 1 0"], ["4 0 1 2 3 255 0 0", "3 0 1 2 0 255 0"],
                        face_properties=rgb))
    assert read_mesh(path).rgba.tolist() == [[255, 0, 0, 255]] * 2 + [[0, 255, 0, 255]]
    path.write_text(ply(["0 0 0 9 0 0 128", "1 0 0 9 0 0 128", "1 1 0 9 0 0 128"], ["3 0 1 2"],
                        ("float x", "float y", "float z", *rgb, "uchar alpha")))
    assert read_mesh(path).rgba.tolist() == [[9, 0, 0, 128]]


GLB = {"position": TRIANGLE}
BAD = {
    "range.obj": ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "vertex index out of range"),
    "none.obj": ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "it has no faces"),
    "empty.obj": ("", "cannot be read as OBJ"),
    "nan.obj": ("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "face 1 of 1 has a corner that is no number"),
    "short.stl": (stl(TRIANGLE, TRIANGLE)[:-20], "cannot be read as STL"),
    "range.ply": (ply(["0 0 0", "1 0 0", "0 1 0"], ["3 0 1 7"]), "a face names vertex 7; it has 3"),
    "short.ply": (ply(["0 0 0", "1 0 0", "0 1 0"], ["3 0 1 2"])[:-9], "cannot be read as PLY"),
    "none.ply": (ply(["0 0 0"], []), "it has no faces"),
    "text.glb": ("not a glb", "cannot be read as GLB"),
    "a.fbx": ("x", "files .fbx are not read; allowed: .obj"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_file_ends_in_one_line_that_names_it(tmp_path, name):
    content, said = BAD[name]
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(UsageError) as error:
        read_mesh(path)
    line, = error.value.lines
    assert line.startswith(f"{path}: ") and said in line and "\n" not in line


@pytest.mark.parametrize(("instead", "said"), [
    ({"extensionsRequired": ["KHR_draco_mesh_compression"]}, "KHR_draco_mesh_compression"),
    ({"nodes": [{"children": [0]}]}, "a child of itself"),
    ({"buffers": [{"byteLength": 10**6}]}, "of 1000000 bytes"),
    ({"accessors": [{"bufferView": 0, "componentType": 5126, "count": 99, "type": "VEC3"}]}, "ends at byte"),
    ({"accessors": []}, "refers to something that it does not have"),
], ids=lambda value: value if isinstance(value, str) else "")
def test_a_bad_gltf_ends_in_one_line(tmp_path, instead, said):
    path = write_glb(tmp_path / "a.glb", [GLB], [], [{"mesh": 0}], [0], instead)
    with pytest.raises(UsageError, match="cannot be read as GLB") as error:
        read_mesh(path)
    assert said in error.value.lines[0]


def test_a_truncated_glb_ends_in_one_line(tmp_path):
    path = write_glb(tmp_path / "a.glb", [GLB], [], [{"mesh": 0}], [0])
    path.write_bytes(path.read_bytes()[:-30])
    with pytest.raises(UsageError, match="cannot be read as GLB"):
        read_mesh(path)


def test_a_file_that_is_not_there_or_too_large_is_named(tmp_path):
    with pytest.raises(UsageError, match=r"gone\.obj: No such file"):
        read_mesh(tmp_path / "gone.obj")
    (tmp_path / "a.obj").write_text(CORNERS + "f 1 2 3\n" * 1000)
    with pytest.raises(UsageError, match="above the limit of 0 MiB"):
        read_mesh(tmp_path / "a.obj", memory_mb=0.001)


def test_a_missing_package_is_named(tmp_path, monkeypatch):
    (tmp_path / "a.ply").write_text("ply")
    monkeypatch.setattr(library.importlib, "import_module", lambda name: (_ for _ in ()).throw(ImportError(name)))
    with pytest.raises(UsageError, match=r"needs the package plyfile; install it: make setup in the folder of "
                       r"mfr-bench, or \S+ -m pip install 'mfr-bench\[mesh\]'"):
        read_mesh(tmp_path / "a.ply")


@pytest.mark.parametrize(("there", "notes"), [
    ("m.mtl", ()), ("a.mtl", ()),  # the library of the file's own name stands for one that is not there
    ("other.mtl", ("the material file m.mtl is not there; what it would colour is grey and opaque",))])
def test_a_material_file_that_is_not_there_is_noted(tmp_path, there, notes):
    (tmp_path / there).write_text(MATERIALS)
    (tmp_path / "a.obj").write_text("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    found = read_mesh(tmp_path / "a.obj")
    assert found.notes == notes
    red, green, blue, alpha = found.rgba[0].tolist()
    assert (red == green == blue and alpha == 255) if notes else [red, green, blue, alpha] == [255, 0, 0, 64]
