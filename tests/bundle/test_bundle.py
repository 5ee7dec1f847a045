"""Bundles: nothing personal in them, nothing odd unnoticed, and nothing crafted read beyond its limits."""

from __future__ import annotations

import getpass
import io
import json
import os
import socket
import zipfile
from pathlib import Path

import numpy as np
import pytest

from mfr_bench.bundle import archive, make_bundle, read_bundle, verified
from mfr_bench.bundle.verify import unpacked
from mfr_bench.errors import UsageError
from mfr_bench.store import ResultFolder
from mfr_bench.store.arrays import write_arrays
from mfr_bench.store.pack import zipped
from mfr_bench.store.record import cell_key

from ..merge.test_merge import DEVICE, content, folder, record
from ..store.test_store import SCENE

RESULTS = Path(__file__).parents[2] / "results"
RATES = {"calibration": {"rates": {"fill_pixels_per_s": 1e9, "copy_bytes_per_s": 1e10}}}


def bundle(*folders, sign_off="A. Smith"):
    return make_bundle(folders, sign_off)[0]


def written(tmp_path, data, name="b.zip"):
    path = tmp_path / name
    path.write_bytes(data)
    return path


def findings(tmp_path, *folders, against=()):
    sets = read_bundle(written(tmp_path, bundle(*folders)))
    return [finding.what for finding in verified(unpacked(sets, tmp_path / "opened"), against)]


def refused(tmp_path, data):
    before = content(tmp_path)
    path = written(tmp_path, data, "crafted.zip")
    with pytest.raises(UsageError) as error:
        read_bundle(path)
    assert len(error.value.lines) == 1 and "refused" in error.value.lines[0]
    assert content(tmp_path) == before | {"crafted.zip": data}
    return error.value.lines[0]


def test_a_bundle_gives_its_results_back(tmp_path):
    source = folder(tmp_path / "n1", record("ab-array"), record("ab-ll"), **RATES)
    data = bundle(source)
    assert data == bundle(source)
    (opened,) = unpacked(read_bundle(written(tmp_path, data)), tmp_path / "opened")
    assert content(opened.cells_path) == content(source.cells_path)
    assert opened.path == tmp_path / "opened" / "card-a" / "planted" and verified([opened]) == []
    assert (opened.path / "results.csv").read_text().count("planted") == 2


def test_nothing_personal_stands_in_it(tmp_path, monkeypatch):
    monkeypatch.setattr(getpass, "getuser", lambda: "jdoe")
    monkeypatch.setattr(socket, "gethostname", lambda: "quartz.example.org")
    reason = f"{tmp_path}/driver.so of jdoe at quartz failed in C:\\Users\\jdoe\\x.dll"
    source = folder(tmp_path / "n1", record("ab-array", device=DEVICE | {"uuid": "GPU-1-2", "pci": "0000:01:00.0"},
                                            status="crashed", reason=reason),
                    environment={"log": "/home/jdoe/runs/log.txt"}, versions={"mfr-bench": "0.1.0"})
    sets = read_bundle(written(tmp_path, bundle(source)))
    text = b"".join(part for files in sets.values() for part in files.values()).decode()
    for word in ("jdoe", "quartz", str(tmp_path), "/home", "Users", "GPU-1-2", "0000:01"):
        assert word not in text
    assert "(removed)" in text and "Card A" in text and "0.1.0" in text
    assert verified(unpacked(sets, tmp_path / "opened")) == []


def test_a_path_in_a_key_is_refused(tmp_path):
    source = folder(tmp_path / "n1", record("ab-array", scene=SCENE | {"file": "/home/jdoe/mesh.obj"}))
    with pytest.raises(UsageError, match="part of its key"):
        bundle(source)


def test_a_frame_faster_than_its_floor_is_odd(tmp_path):
    floor, fast = record("floor", values={"time_ms": 3.0}), record("ab-array", values={"time_ms": 1.0})
    assert findings(tmp_path, folder(tmp_path / "n1", floor, fast)) == [
        "its frame takes 1 ms at most, and drawing the geometry alone 3 ms at least"]


def test_a_frame_faster_than_the_device_fills_is_odd(tmp_path):
    fast = record("ab-array", values={"time_ms": 0.001, "covered_pixels": 10**7})
    (found,) = findings(tmp_path, folder(tmp_path / "n1", fast, **RATES))
    assert "filling its pixels 5 ms at least" in found


@pytest.mark.parametrize(("memory", "odd"), [(2**31, 1), (2**27, 0)])
def test_a_frame_faster_than_memory_takes_what_it_keeps_is_odd(tmp_path, memory, odd):
    values = {"time_ms": 10.0, "fragments": 2**28, "hit_ratio": 1.0, "memory_bytes": memory}
    found = findings(tmp_path, folder(tmp_path / "n1", record("ab-array", values=values), **RATES))
    assert found == ["its frame takes 10 ms, and writing the fragments that it keeps 53.7 ms at least"] * odd


def test_an_error_far_below_every_other_device_is_odd_but_in_software(tmp_path):
    others = [other_device(tmp_path / slug, slug, 0.2) for slug in ("card-b", "card-c")]
    mine = folder(tmp_path / "n1", record("ab-array", values={"max_abs_error": 0.0}))
    assert findings(tmp_path, mine, against=others) == ["its error is 0, that of 2 other devices 0.2 at least"]
    cpu = DEVICE | {"slug": "cpu", "renderer": "llvmpipe (LLVM 15.0.6, 256 bits)"}
    software = folder(tmp_path / "n2", record("ab-array", device=cpu, values={"max_abs_error": 0.0}), device=cpu)
    assert findings(tmp_path, software, against=others) == []


KEPT = {"target_rel_ci": 0.1, "min_samples": 3, "max_samples": 9, "time_limit_s": 1.0, "keep": ["image", "error"]}


@pytest.mark.parametrize(("kept", "said"), [
    (("image", "error"), []), (("image",), ["it keeps error, of which no array is here"]),
    ((), ["it keeps image, error, of which no array is here"])])
def test_arrays_that_a_record_keeps_must_be_there(tmp_path, kept, said):
    made = record("kplus-array", measure=KEPT)
    source = folder(tmp_path / "n1", made, record("floor", measure=KEPT))
    write_arrays(source, made["key"], {name: np.zeros((6, 8, 4) if name == "image" else (6, 8)) for name in kept})
    assert findings(tmp_path, source) == said


def test_an_array_of_another_viewport_is_odd(tmp_path):
    made = record("kplus-array", measure=KEPT)
    source = folder(tmp_path / "n1", made)
    write_arrays(source, made["key"], {"image": np.zeros((5, 8, 4)), "error": np.zeros((6, 8))})
    assert findings(tmp_path, source) == [
        "its kept arrays are not of its viewport, [6, 8] rows and columns: image has [5, 8]"]


def test_a_damaged_array_is_odd(tmp_path):
    made = record("kplus-array", measure=KEPT)
    source = folder(tmp_path / "n1", made)
    write_arrays(source, made["key"], {"image": np.zeros((2, 3, 4)), "error": np.zeros((2, 3))})
    packed = zipfile.ZipFile(source.arrays_path(made["key"]))
    broken = zipped({"image.npy": packed.read("image.npy")[:-5], "error.npy": packed.read("error.npy")})
    source.write_contents({f"{made['key']}.npz": broken})
    (found,) = findings(tmp_path, source)
    assert found.startswith("its kept arrays cannot be read:")


def other_device(path, slug, error):
    device = DEVICE | {"slug": slug, "renderer": slug}
    return folder(path, record("ab-array", device=device, values={"max_abs_error": error}), device=device)


@pytest.mark.parametrize(("error", "odd"), [(1e-7, 0), (5e-5, 1)])
def test_an_error_unlike_every_other_device_is_odd(tmp_path, error, odd):
    mine = folder(tmp_path / "n1", record("ab-array", values={"max_abs_error": error}))
    others = [other_device(tmp_path / slug, slug, 2e-7) for slug in ("card-b", "card-c")]
    assert len(findings(tmp_path, mine, against=others)) == odd
    assert not verified(unpacked(read_bundle(tmp_path / "b.zip"), tmp_path / "again"), others[:1])


@pytest.mark.parametrize("altered", [False, True])
def test_a_kept_image_is_held_to_the_oracle(tmp_path, altered):
    from mfr_bench.oracle.composite import composite
    from mfr_bench.scene import Scene, generate

    scene = Scene(size=(16, 12), depth_complexity=4, seed=7)
    image = np.rint(255 * np.clip(composite(generate(scene)), 0, 1))
    if altered:
        image[3, 4] = 255 - image[3, 4]
    kept = record("ab-array", scene=scene.as_dict(), values={"max_abs_error": 1e-7, "fragments": 768})
    source = folder(tmp_path / "n1", kept)
    write_arrays(source, kept["key"], {"image": image})
    found = findings(tmp_path, source)
    assert len(found) == altered and all("differs from the oracle" in what for what in found)


@pytest.mark.parametrize("two_channel", [True, False])
def test_a_kept_image_of_two_channels_or_of_an_effect_is_held_to_its_own_oracle(tmp_path, two_channel):
    from mfr_bench.oracle import twochannel
    from mfr_bench.oracle.composite import composite
    from mfr_bench.oracle.effects import answer_of_effect
    from mfr_bench.oracle.listed import listed
    from mfr_bench.scene import Scene, generate

    scene = Scene(size=(16, 12), depth_complexity=4, seed=7, effect="transparency" if two_channel else "layers")
    made = generate(scene)
    plain = composite(made)
    right = (composite(made, payload=twochannel.straight(made.rgba)) if two_channel
             else answer_of_effect(listed(made), made.effect).image)
    assert np.abs(np.clip(right, 0, 1) - plain).max() > 0.01
    for image, odd in ((right, 0), (plain, 1)):
        kept = record("ab-array", scene=scene.as_dict(), values={"max_abs_error": 1e-7, "fragments": 768},
                      params={"payload": "two_channel"} if two_channel else {})
        source = folder(tmp_path / f"n{odd}", kept)
        write_arrays(source, kept["key"], {"image": np.rint(255 * np.clip(image, 0, 1))})
        assert len(findings(tmp_path, source)) == odd


# --- crafted files -------------------------------------------------------------------------------


def crafted(files, index=None):
    return zipped({archive.INDEX: index if index is not None else archive.index_of(files, ""), **files})


def good_set(**more):
    made = record("ab-array")
    return {"card-a/planted/manifest.json": b'{"schema": 1}',
            "card-a/planted/cells.zip": zipped({f"{made['key']}.json": b"{}"} | more)}


@pytest.mark.parametrize("name", ["../up/x/manifest.json", "/etc/passwd", "card-a/planted/cells/x.json", "a/b/run.py",
                                  "card-a/../manifest.json", "a\\b/c/manifest.json", "card-a/.git/manifest.json"])
def test_a_member_outside_of_the_layout_is_refused(tmp_path, name):
    assert "that no bundle has" in refused(tmp_path, crafted(good_set() | {name: b"{}"}))


def test_a_member_of_a_pack_outside_of_the_layout_is_refused(tmp_path):
    assert "that no bundle has" in refused(tmp_path, crafted(good_set(**{"../../x.json": b"{}"})))


def test_a_wrong_hash_is_refused(tmp_path):
    index = archive.index_of(good_set(), "")
    assert "not of the hash" in refused(tmp_path, crafted(good_set(**{"0" * 20 + ".json": b"{ }"}), index))


def test_what_is_no_zip_or_has_no_index_is_refused(tmp_path):
    refused(tmp_path, b"PK not a zip")
    assert "has no bundle.json" in refused(tmp_path, zipped(good_set()))
    assert "has no bundle.json" in refused(tmp_path, crafted(good_set(), b'{"schema": 2, "sha256": {}}'))


def test_more_bytes_than_the_limit_are_not_unpacked(tmp_path, monkeypatch):
    monkeypatch.setattr(archive.Budget.__init__, "__defaults__", (4 * archive.PIECE_BYTES,))
    monkeypatch.setattr(archive, "OPENED_BYTES", 4 * archive.PIECE_BYTES)
    zeros = b"\0" * (16 * archive.PIECE_BYTES)
    assert "unpacks to more than 4 MiB" in refused(tmp_path, crafted(good_set(**{"1" * 20 + ".json": zeros})))


def test_more_cells_than_a_config_may_have_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "MAX_CELLS", 2)
    many = {f"{number:020x}.json": b"{}" for number in range(9)}
    assert "more than 4" in refused(tmp_path, crafted(good_set(**many)))
    del many["0" * 19 + "1.json"]
    for number in range(2, 8):
        del many[f"{number:020x}.json"]
    assert "has 3 cells in one set, more than 2" in refused(tmp_path, crafted(good_set(**many)))
    manifest = json.dumps({"schema": 1, "cells": ["0"] * 3}).encode()
    assert "names 3 cells, more than 2" in refused(tmp_path, crafted(
        good_set() | {"card-a/planted/manifest.json": manifest}))


@pytest.mark.parametrize("large", [False, True])
def test_millions_of_members_are_refused_before_any_is_listed(monkeypatch, large):
    packed = zipped({f"{number:020x}.json": b"" for number in range(9)})
    if large:  # the form for large files tells the size of the index elsewhere
        end = packed.rfind(archive.END)
        packed = packed[:end] + archive.END_64 + b"\0" * 16 + packed[end:end + 12] + b"\0" * 4 + packed[end + 16:]
    monkeypatch.setattr(archive.zipfile, "ZipFile", None)
    with pytest.raises(ValueError, match="has 9 members, more than 8"):
        archive._members(packed, archive.Budget(), 8, bool)


@pytest.mark.parametrize("make", [os.mkfifo, lambda path: os.symlink("/dev/zero", path)])
def test_what_never_ends_is_not_read(tmp_path, make):
    make(tmp_path / "b.zip")
    with pytest.raises(UsageError, match="is no file; refused"):
        read_bundle(tmp_path / "b.zip")


def test_nothing_is_written_of_a_set_with_a_record_that_is_none(tmp_path):
    sets = read_bundle(written(tmp_path, crafted(good_set())))
    with pytest.raises(UsageError, match=r"^card-a/planted: cell [0-9a-f]{20}: "):
        unpacked(sets, tmp_path / "opened")
    assert not (tmp_path / "opened").exists()


def test_a_member_twice_is_refused(tmp_path):
    made = io.BytesIO(crafted(good_set()))
    with zipfile.ZipFile(made, "a") as bundle_file, pytest.warns(UserWarning, match="Duplicate name"):
        bundle_file.writestr("card-a/planted/manifest.json", b"{}")
    assert "or has it twice" in refused(tmp_path, made.getvalue())


@pytest.mark.parametrize("broken", [b"[" * 100_000, b'{"schema": 1, "key": ' + b"9" * 10_000 + b"}", b"\xff", b"{}"])
def test_records_that_are_none_are_refused(tmp_path, broken):
    key = record("ab-array")["key"]
    pack = {"card-a/planted/cells.zip": zipped({f"{key}.json": broken})}
    sets = read_bundle(written(tmp_path, crafted(good_set() | pack)))
    with pytest.raises(UsageError) as error:
        verified(unpacked(sets, tmp_path / "opened"))
    assert len(error.value.lines) == 1


def test_a_number_beyond_any_measurement_is_refused(tmp_path):
    made = record("ab-array")
    source = folder(tmp_path / "n1", made)
    path = source.cells_path / f"{made['key']}.json"
    path.write_text(path.read_text().replace('"time_ms": 2.0', '"time_ms": 1e300'))
    sets = read_bundle(written(tmp_path, crafted({
        "card-a/planted/manifest.json": (source.path / "manifest.json").read_bytes(),
        "card-a/planted/cells.zip": zipped({path.name: path.read_bytes()})})))
    with pytest.raises(UsageError, match="values"):
        verified(unpacked(sets, tmp_path / "opened"))


def test_a_record_that_was_altered_is_refused(tmp_path):
    altered = record("ab-array") | {"glsl_hash": "other"}
    assert altered["key"] != cell_key(altered, "wall")
    with pytest.raises(UsageError, match="not what its key names"):
        bundle(folder(tmp_path / "n1", altered))


def test_the_committed_results_make_a_bundle(tmp_path):
    sources = [ResultFolder(path.parent) for path in sorted(RESULTS.glob("llvmpipe-*/sorts/manifest.json"))]
    assert sources and findings(tmp_path, *sources) == []
