"""Bundles whose records, manifests or arrays were crafted: refused in one line or named as odd, never a traceback."""

from __future__ import annotations

import io
import json
import zipfile

import numpy as np
import pytest

from mfr_bench.bundle import archive, make_bundle, read_bundle, verified
from mfr_bench.bundle.verify import unpacked
from mfr_bench.errors import UsageError
from mfr_bench.scene import Scene
from mfr_bench.store import ResultFolder
from mfr_bench.store.arrays import read_arrays
from mfr_bench.store.pack import zipped

from ..merge.test_merge import DEVICE, folder, record
from .test_bundle import crafted, written

MANIFEST = {"schema": 1, "name": "planted", "device": DEVICE, "timer": "wall", "cells": []}
SMALL = Scene(size=(16, 12), depth_complexity=4).as_dict()


def told(tmp_path, *records, manifest=MANIFEST, arrays=None):
    """The findings in a bundle with these records and arrays, whose hashes are right."""
    cells = {f"{r['key']}.json": json.dumps({"schema": 1} | r).encode() for r in records}
    cells |= {f"{key}.npz": content for key, content in (arrays or {}).items()}
    data = crafted({"card-a/planted/manifest.json": json.dumps(manifest).encode(),
                    "card-a/planted/cells.zip": zipped(cells)})
    return [f.what for f in verified(unpacked(read_bundle(written(tmp_path, data)), tmp_path / "opened"))]


def npz(name, content):
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr(name, content)
    return made.getvalue()


def header(shape):
    made = io.BytesIO()
    np.lib.format.write_array_header_1_0(made, {"descr": "|u1", "fortran_order": False, "shape": shape})
    return made.getvalue()


def image():
    made = io.BytesIO()
    np.savez_compressed(made, image=np.zeros((12, 16, 4), np.uint8))
    return made.getvalue()


@pytest.mark.parametrize("manifest", [
    {name: value for name, value in MANIFEST.items() if name != "timer"},
    MANIFEST | {"name": "../up"}, MANIFEST | {"name": "\x1b[2Jplanted"}, MANIFEST | {"device": {"slug": "card-b"}}])
def test_a_manifest_that_names_no_timer_or_another_set_is_refused(tmp_path, manifest):
    altered = record("ab-array") | {"glsl_hash": "other"}  # which only the key tells, and the key only with the timer
    with pytest.raises(UsageError, match="card-a/planted: its manifest names") as error:
        told(tmp_path, altered, manifest=manifest)
    assert str(error.value).isprintable()


@pytest.mark.parametrize("part", [{"size": [0.5, 5]}, {"size": [-1, 5]}, {"layout": "none"}, {"alpha": None},
                                  {"depth_complexity": "many"}, {"depth_complexity": 10**9}, {"unknown": None}])
def test_a_scene_that_no_config_has_is_odd(tmp_path, part):
    lying = record("ab-array", scene=SMALL | part, values={"fragments": 5})
    found, = told(tmp_path, lying, arrays={lying["key"]: image()})
    assert found.startswith("its scene is none that a config can have: ")


def test_a_scene_without_its_keys_is_odd(tmp_path):
    lying = record("ab-array", scene={"size": [8, 6], "kind": "quads"})
    assert "none that a config can have" in told(tmp_path, lying, arrays={lying["key"]: image()})[0]


def test_a_scene_is_as_large_as_it_is_and_not_as_its_record_says(tmp_path, monkeypatch):
    def never(scene, frame=0):
        raise AssertionError(f"made {scene}")

    monkeypatch.setattr("mfr_bench.bundle.verify.generate", never)
    lying = record("ab-array", scene=SMALL | {"size": [16000, 16000]}, values={"fragments": 5})
    assert told(tmp_path, lying, arrays={lying["key"]: image()}) == []


def test_arrays_count_by_what_they_unpack_to(tmp_path, monkeypatch):
    monkeypatch.setattr(archive.Budget.__init__, "__defaults__", (4 * archive.PIECE_BYTES,))
    large = record("ab-array", scene=SMALL)
    content = npz("image.npy", header((4096, 4096, 1)) + bytes(4096**2))
    assert len(content) < archive.PIECE_BYTES
    with pytest.raises(UsageError, match="unpacks to more than"):
        told(tmp_path, large, arrays={large["key"]: content})


@pytest.mark.parametrize("content", [b"no zip", npz("other.npy", b""), npz("../../image.npy", b"")])
def test_arrays_that_are_none_are_refused(tmp_path, content):
    made = record("ab-array", scene=SMALL)
    with pytest.raises(UsageError, match="refused"):
        told(tmp_path, made, arrays={made["key"]: content})


@pytest.mark.parametrize("content", [header((200_000, 200_000, 4)), b"no array", b"\x93NUMPY\x01\x00\x04\x00{bad"])
def test_an_array_that_cannot_be_used_is_named(tmp_path, content):
    made = ResultFolder(tmp_path)
    made.write_contents({"0" * 20 + ".npz": npz("image.npy", content)})
    assert read_arrays(made, "0" * 20) == {} and "left in place" in made.damaged[0]


@pytest.mark.parametrize("package", ["name", {"name": "other"}, {"name": 1, "hash": "0"}])
def test_a_package_without_name_and_hash_is_refused(tmp_path, package):
    with pytest.raises(UsageError, match="package: missing or of the wrong type"):
        told(tmp_path, record("ab-array") | {"package": package})


@pytest.mark.parametrize("calibration", [[5], {"rates": 5}, {"rates": {"fill_pixels_per_s": "fast"}}])
def test_a_calibration_of_other_types_is_left_out(tmp_path, calibration):
    cell = record("ab-array", values={"time_ms": 1.0, "covered_pixels": 10})
    assert told(tmp_path, cell, manifest=MANIFEST | {"calibration": calibration}) == []


def test_a_name_in_the_name_of_a_set_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("getpass.getuser", lambda: "jdoe")
    with pytest.raises(UsageError, match="a config of another name"):
        make_bundle([folder(tmp_path / "n1", record("ab-array"), name="jdoe-tries")], "A. Smith")


def test_results_whose_keys_cannot_be_held_to_their_timer_make_no_bundle(tmp_path):
    with pytest.raises(UsageError, match="names no timer"):
        make_bundle([folder(tmp_path / "n1", record("ab-array"), timer=None)], "A. Smith")


@pytest.mark.parametrize("nobody", ["", "  "])
def test_somebody_signs_off(tmp_path, nobody):
    with pytest.raises(UsageError, match="nobody signs off"):
        make_bundle([folder(tmp_path / "n1", record("ab-array"))], nobody)
