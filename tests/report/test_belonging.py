"""Rows that a folder's config does not have stay out of tables and figures, and are said to be there."""

import pytest

from mfr_bench.report import data, tables
from mfr_bench.store import ResultFolder, derive

from . import planted

AB = {"id": "ab-array", "label": "mine", "params": {}}
KPLUS = {"id": "kplus-array", "label": "K+", "params": {"culling": False}}
CONFIG = {"methods": [AB, KPLUS], "sweep": {"k": [4, 8], "scene.pixel_density": [0.5, 1.0]}, "zip": {},
          "scene": planted.SCENE, "params": {"load_factor": 0.5}}


def cell(method="ab-array", label="mine", density=0.5, k=None, scene=None, **more):
    point = {"scene.pixel_density": density} | ({} if k is None else {"k": k})
    params = more.pop("params", {}) | ({} if k is None else {"k": k})
    return planted.cell(method, label, params=params, point=point, scene={"pixel_density": density} | (scene or {}),
                        **more)


def loaded(tmp_path, extra, **changed):
    """A folder whose plan has one cell, with another one beside it."""
    made = planted.folder(tmp_path / "made", [cell()], **CONFIG | changed)
    made.write_cell(extra)
    return data.load(ResultFolder(made.path))


@pytest.mark.parametrize("extra", [
    cell(density=1.0), cell(device=planted.DEVICE | {"slug": "other"}), cell("floor", "Blending floor"),
    cell("kplus-array", "K+", k=4, params={"culling": "off"}), cell("kplus-array", "K+", 1.0, k=8)], ids=str)
def test_what_the_config_has_is_shown(tmp_path, extra):
    result = loaded(tmp_path, extra)
    assert len(result.points) == 2 and result.left_out == 0 and not result.foreign


@pytest.mark.parametrize("extra", [
    cell(label="AB_Array"), cell("ab-sb"), cell(density=0.25), cell(scene={"seed": 2}),
    cell("kplus-array", "K+", k=16), cell("kplus-array", "K+", params={"k": 4}),
    cell("kplus-array", "K+", k=4, params={"culling": "on"}), cell(params={"load_factor": 0.4})], ids=str)
def test_what_the_config_no_longer_has_is_left_out_and_told(tmp_path, extra):
    result = loaded(tmp_path, extra)
    assert [p.label for p in result.points] == ["mine"] and result.left_out == 1
    told = "1 row of the folder left out: not of the config that ran last"
    assert told in result.lacking
    assert told in " ".join(tables.terminal_table(result.folder).split())
    assert told in tables.markdown(result)
    derive(result.folder)
    assert (result.folder.path / "results.csv").read_text().count("\n") == 3  # the store has every row


def test_a_cell_of_another_default_is_replaced_by_the_planned_one(tmp_path):
    """An earlier version of a method sorted otherwise by default: the config has one row of it, not two."""
    old = planted.cell("ab-array", "mine", params={"sort": "hybrid"}, point={"scene.pixel_density": 0.5},
                       scene={"pixel_density": 0.5})
    new = planted.cell("ab-array", "mine", params={"sort": "auto"}, point={"scene.pixel_density": 0.5},
                       scene={"pixel_density": 0.5})
    made = planted.folder(tmp_path, [new], **CONFIG)
    made.write_cell(old)
    (point,) = data.load(ResultFolder(made.path)).points
    assert (point.label, point.cell["params"]["sort"]) == ("mine", "auto")


def test_zipped_values_belong_to_each_other(tmp_path):
    zipped = {"zip": CONFIG["sweep"], "sweep": {}}
    assert loaded(tmp_path / "a", cell("kplus-array", "K+", 0.5, k=4), **zipped).left_out == 0
    assert loaded(tmp_path / "b", cell("kplus-array", "K+", 0.5, k=8), **zipped).left_out == 1


def test_r_sets_the_depth_complexity(tmp_path):
    swept = {"sweep": {"r": [2, 4]}, "params": {"k": 8}}
    other = planted.cell("ab-array", "mine", point={"r": 4}, scene={"depth_complexity": 32})
    assert loaded(tmp_path, other, **swept).left_out == 0


def test_an_older_manifest_that_lists_no_methods_has_every_row(tmp_path):
    made = planted.folder(tmp_path / "made", [cell()])
    made.write_cell(cell(label="other"))
    assert len(data.load(made).points) == 2
