"""The shaders of the page: each variant once, with the geometry that its cells were drawn with."""

import base64
import json
import zlib

import pytest

from mfr_bench.effects import Settings
from mfr_bench.glsl.digest import glsl_hash, stages_by_pass
from mfr_bench.methods import catalog
from mfr_bench.page import shaders
from mfr_bench.report import data

from ..report import planted

SCENES = {"quad": {}, "strip": {"slant": 0.01}, "triangle": {"kind": "mesh"},
          "reversed": {"kind": "mesh", "depth_range": "reversed"}, "masked": {"kind": "fragments", "msaa": 4}}


def points(path, cells):
    return data.load(planted.folder(path, cells)).points


@pytest.mark.parametrize("geometry", SCENES)
def test_the_shaders_are_those_of_the_geometry_that_was_drawn(tmp_path, geometry):
    """They are today's where their hash is the recorded one, and the texts are those that the hash covers."""
    scene, variant = planted.SCENE | SCENES[geometry], catalog()["kplus-heap"].variant({})
    ran = glsl_hash(variant, geometry, Settings.of(scene))
    found = shaders.shaders_of(points(tmp_path / "a", [planted.cell("kplus-heap", scene=scene, glsl_hash=ran)]))
    assert [(entry.hash, entry.current) for entry in found.entries] == [(ran, True)]
    unpacked = json.loads(zlib.decompress(base64.b64decode(found.packed)))
    shown = {"\n".join(unpacked["lines"][line] for line in text) for text in unpacked["texts"]}
    assert shown == {stage.text for step, stages in stages_by_pass(variant, geometry, Settings.of(scene))
                     for stage in stages if not step.probes}


def test_a_hash_of_other_shaders_is_not_todays(tmp_path):
    others = {glsl_hash(catalog()["kplus-heap"].variant({}), geometry) for geometry in ("strip", "triangle")}
    for ran in others:
        (entry,) = shaders.shaders_of(points(tmp_path / ran, [planted.cell("kplus-heap", glsl_hash=ran)])).entries
        assert not entry.current


def test_each_variant_is_made_once(tmp_path, monkeypatch):
    """Cells that differ in their scene alone, or in a parameter that older records lack, share their shaders."""
    made = []
    monkeypatch.setattr(shaders, "stages_by_pass", lambda *given: made.append(given) or stages_by_pass(*given))
    cells = [planted.cell("kplus-heap", scene={"depth_complexity": n}, params=params, point={"n": n, **params})
             for n in (4, 8, 16) for params in ({}, {"k": 16}, catalog()["kplus-heap"].complete({"k": 16}))]
    found = shaders.shaders_of(points(tmp_path / "a", cells))
    assert len(made) == 2
    assert [entry.name for entry in found.entries] == ["kplus-heap", "kplus-heap (k 16)"]


def test_what_the_catalog_no_longer_has_is_left_out(tmp_path):
    cells = [planted.cell("gone"), planted.cell("kplus-heap", params={"bound": "gone"}), planted.cell("ab-array")]
    assert [entry.name for entry in shaders.shaders_of(points(tmp_path / "a", cells)).entries] == ["ab-array"]
