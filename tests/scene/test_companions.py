"""What a mesh is, is what all its files are: materials, textures and buffers count in its digest and its folder."""

import json

import pytest
from PIL import Image

from mfr_bench.cli.mesh_scene import mesh_overrides
from mfr_bench.scene.files import digest, digest_of

from .mesh_files import TRIANGLE, surface, write_glb

OBJ = "mtllib {}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"


def texture(path, shade):
    Image.new("L", (2, 2), shade).save(path)


def model(folder, library="m.mtl", opacity=0.5, shade=100, materials="m.mtl"):
    (folder / "a.obj").write_text(OBJ.format(library))
    (folder / materials).write_text(f"newmtl a\nd {opacity}\nmap_Kd -s 1 1 1 t.png\n")
    texture(folder / "t.png", shade)
    return digest([folder / "a.obj"], "a mesh")


@pytest.mark.parametrize("changed", [{"opacity": 0.4}, {"shade": 101}])
def test_materials_and_textures_of_an_obj_count(tmp_path, changed):
    first = model(tmp_path)
    assert model(tmp_path) == first
    assert model(tmp_path, **changed) != first


def test_the_library_that_is_taken_for_a_missing_one_counts(tmp_path):
    first = model(tmp_path, library="gone.mtl", materials="a.mtl")
    assert model(tmp_path, library="gone.mtl", materials="a.mtl", opacity=0.1) != first


def test_buffers_and_images_of_a_gltf_count(tmp_path):
    document = {"asset": {"version": "2.0"}, "buffers": [{"uri": "my%20data.bin", "byteLength": 4}],
                "images": [{"uri": "t.png"}, {"uri": "data:,"}, {"bufferView": 0}]}
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    seen = set()
    for data, shade in ((b"1234", 1), (b"1235", 1), (b"1235", 2)):
        (tmp_path / "my data.bin").write_bytes(data)
        texture(tmp_path / "t.png", shade)
        seen.add(digest([tmp_path / "a.gltf"], "a mesh"))
    assert len(seen) == 3


@pytest.mark.parametrize("text", [b"", b"{", b"[]", b"glTF", b'{"buffers": [1]}', b'{"buffers": [{"uri": 3}]}',
                                  b"\xff\xfe", b'{"images": 7}'])
@pytest.mark.parametrize("ending", ["gltf", "glb", "obj", "ply"])
def test_a_damaged_file_still_has_a_digest(tmp_path, ending, text):
    (tmp_path / f"a.{ending}").write_bytes(text)
    assert len(digest([tmp_path / f"a.{ending}"], "a mesh")) == 16


def test_files_of_other_contents_or_endings_have_folders_of_their_own(tmp_path):
    names = set()
    for opacity in (0.5, 0.4):
        model(tmp_path, opacity=opacity)
        names.add(mesh_overrides(str(tmp_path / "a.obj"))[0])
    write_glb(tmp_path / "a.glb", [{"position": TRIANGLE, "material": 0}], [surface(0.5)], [{"mesh": 0}], [0])
    names.add(mesh_overrides(str(tmp_path / "a.glb"))[0])
    assert len(names) == 3 and sorted(name[:15] for name in names) == ["name=mesh-a-glb", *["name=mesh-a-obj"] * 2]


def test_any_name_of_a_file_makes_a_folder(tmp_path):
    path = tmp_path / f"mö del (1) {'x' * 90}.OBJ"
    model(tmp_path)
    (tmp_path / "a.obj").rename(path)
    name = mesh_overrides(str(path))[0].removeprefix("name=")
    assert name.startswith("mesh-m--del--1--xxx") and "-obj-" in name and len(name) < 100


def test_a_decision_knows_the_contents_of_its_files(tmp_path):
    first = model(tmp_path)
    scene = {"kind": "mesh", "file": str(tmp_path / "a.obj")}
    assert digest_of(scene) == first == digest_of({"files": [{"file": scene["file"]}]})
    assert digest_of({"kind": "quads"}) is None
