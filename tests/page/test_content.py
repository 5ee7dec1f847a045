"""The page's text: complete without a script, and silent about machines, users and paths."""

import base64
import hashlib
import io
import json
import re

import numpy as np
import pytest
from markupsafe import escape
from PIL import Image

from mfr_bench.page.content import MEASURED, command_of, to_the_fastest, without_paths
from mfr_bench.page.pictures import figure_picture, kept_picture
from mfr_bench.page.write import SCRIPTS, _file, page_text, write_page
from mfr_bench.report import data, style
from mfr_bench.report.figures import figure_paths

from ..report import planted


@pytest.fixture(scope="module")
def text(page):
    return page.read_text()


def test_every_cell_stands_in_the_table_with_its_values(results, text):
    points = data.load(results).points
    rows = re.findall(r"<tr data-m=.*?</tr>", text)
    colours = json.loads(re.search(r'id="colours">(.*?)<', text)[1])
    assert len(rows) == len(points)
    for point, row in zip(points, rows, strict=True):
        assert point.label in row and f">{point.sign}<" in row
        assert colours[int(re.match(r"<tr data-m=(\d+)>", row)[1])] == style.method_colour(point.row["method"])
        if point.row["time_ms"] is not None:
            low, high = (point.row[f"time_ms_{end}"] for end in ("low", "high"))
            assert f"data-i={low:.4g},{high:.4g}>{data.number(point.row['time_ms'])} ({data.number(low)}–" in row
        else:
            assert point.row["reason"] in row
    assert all(f">{column.heading}</th>" in text for column in MEASURED)


def test_the_small_print_of_figures_stands_below_them_as_text(results, text):
    found = [figure_picture(path)[3] for path in figure_paths(data.load(results))]
    assert found and all(said[-1].startswith("kplus2015") or "llvmpipe" in said[-1] for said in found)
    assert all(f"{escape(without_paths(line))}<br>" in text for said in found for line in said)


def test_times_are_over_that_of_the_fastest_of_the_scene_that_shows_every_fragment(tmp_path):
    cells = [planted.cell("floor", "floor", 1.0), planted.cell("zbuffer", "Z-buffer", 1.5, values={"rmse": 0.2}),
             planted.cell("ab-ll", "AB_LL", 4.0), planted.cell("ab-sb", "AB_SB", 10.0)]
    result = data.load(planted.folder(tmp_path, cells))
    found = to_the_fastest(result.points)
    assert {p.label: round(found[id(p)], 3) for p in result.points if id(p) in found} == {"AB_LL": 1.0, "AB_SB": 2.5}


def test_what_the_time_left_out_and_an_unsteady_machine_are_marked(tmp_path):
    folder = planted.folder(tmp_path, [planted.cell("ab-ll", "AB_LL", 4.0)],
                            calibration_drift="the same work took 2 times as long")
    assert '<p class="warn">unsteady: the same work took 2 times as long</p>' in page_text([folder])
    manifest = folder.manifest()
    folder.write_manifest(manifest | {"cells": [*manifest["cells"], "another"], "left_out": {"AB_SB": 1},
                                      "calibration_drift": None})
    text = page_text([folder])
    assert '<p class="warn">1 planned cell has no record, left out for the time budget</p>' in text
    assert "unsteady" not in text


def test_figures_and_kept_images_are_inside(text):
    images = re.findall(r'<img src="data:image/webp;base64,([^"]+)" width="(\d+)" height="(\d+)"', text)
    assert len(images) == 3
    for content, width, height in images:
        with Image.open(io.BytesIO(base64.b64decode(content))) as image:
            assert image.format == "WEBP" and image.size == (int(width), int(height))


def test_no_host_user_or_path_stands_in_the_page(results, text):
    for word in ("secret-host", "/home", "somebody", str(results.path.parent)):
        assert word not in text
    assert without_paths("cannot open /home/ann/a.yaml: no such file") == "cannot open (path): no such file"
    assert without_paths("time/memory, 3/4 and and/or stay") == "time/memory, 3/4 and and/or stay"


def test_nothing_is_loaded_from_anywhere_and_only_these_scripts_run(text):
    assert re.findall(r"(?:src|href)=[\"'](?!data:|#)", text) == []
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', text)[1].replace("&#39;", "'")
    assert policy.startswith("default-src 'none'")
    for name in SCRIPTS:
        digest = base64.b64encode(hashlib.sha256(_file(name).encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy and _file(name) in text


def test_markup_in_names_is_text(tmp_path):
    evil = "<script>alert(1)</script>"
    folder = planted.folder(tmp_path / "x", [planted.cell(label=evil, reason=evil)], title=evil)
    assert evil not in page_text([folder])


def test_the_page_is_the_same_each_time_and_of_several_folders(results, tmp_path):
    other = planted.folder(tmp_path / "other", [planted.cell()])
    first = page_text([results, other])
    assert first == page_text([results, other])
    assert first.count('class="experiment"') == 2


def test_a_page_of_one_experiment_has_its_title_once(tmp_path):
    one, other = (planted.folder(tmp_path / x, [planted.cell()], title=f"Title {x}") for x in "ab")
    assert page_text([one]).count(">Title a</h") == 1
    assert re.findall(r">(Title .)</h2>", page_text([one, other])) == ["Title a", "Title b"]


def test_an_empty_folder_has_a_page(tmp_path):
    assert 'id="e1"' in page_text([planted.folder(tmp_path / "none", [])])


@pytest.mark.parametrize(("manifest", "command"), [
    ({"config": "meshes.yaml", "scene": {"kind": "mesh", "file": "/home/a/my model.glb", "size": [64, 48]}},
     "mfr-bench run --mesh 'my model.glb' --size 64x48"),
    ({"config": "meshes.yaml", "scene": {"kind": "mesh", "file": "a.glb", "size": [64, 48]},
      "measure": {"memory_budget_mb": 64.0}}, "mfr-bench run --mesh a.glb --size 64x48 --memory-mb 64"),
    ({"config": "smoke.yaml", "scene": {"kind": "quads"}, "measure": {"memory_budget_mb": 64.0}},
     "mfr-bench run smoke"),
    ({"config": "meshes.yaml", "scene": {"kind": "fragments", "file": "/home/a/recorded.npz", "size": [64, 48]}},
     "mfr-bench run --fragments recorded.npz"),
    ({"config": "mesh-model.yaml", "scene": {"kind": "mesh", "file": "model.glb"}}, "mfr-bench run mesh-model"),
    ({"config": "smoke.yaml", "scene": {"kind": "quads"}, "profile": "long"}, "mfr-bench run smoke --profile long"),
    ({"config": "smoke.yaml", "scene": {"kind": "quads"}, "settings": ["--set", "scene.size=[8, 8]", "--only", "kb"]},
     "mfr-bench run smoke --set 'scene.size=[8, 8]' --only kb"),
    ({"config": "smoke.yaml", "scene": {"kind": "quads"}, "settings": ["--set", "scene.file=/home/ann/a.obj"]},
     "mfr-bench run smoke --set 'scene.file=(path)'"),
])
def test_the_command_of_an_experiment_measures_what_it_shows(manifest, command):
    assert command_of(manifest, "mesh-model") == command


def test_the_papers_claims_stand_on_pages_of_their_experiments_alone(tmp_path):
    assert 'id="claims"' not in page_text([planted.folder(tmp_path / "own", [planted.cell()])])
    paper = planted.folder(tmp_path / "paper", [planted.cell()], name="kplus2015-fig6")
    assert 'id="claims"' in page_text([paper])


def test_a_kept_image_is_upright_over_a_checkerboard():
    image = np.zeros((200, 200, 4), dtype=np.uint8)
    image[100:] = (255, 0, 0, 255)  # the upper half
    uri, width, height = kept_picture(image)
    from io import BytesIO

    from PIL import Image

    shown = np.asarray(Image.open(BytesIO(base64.b64decode(uri.partition(",")[2]))))
    assert shown.shape == (height, width, 3)
    assert (shown[:height // 2] == (255, 0, 0)).all()
    assert set(np.unique(shown[height // 2:])) == {204, 255}


def test_every_measure_is_aligned_as_a_number():
    """The first of nine, the time, was broken into three lines and stood at the left."""
    assert f".cells td:nth-last-child(-n + {len(MEASURED)})" in _file("page.css")


def test_the_libraries_are_those_that_their_list_names():
    listed = dict(re.findall(r"\| `(\S+)` \|.*\| `([0-9a-f]{64})` \|", _file("vendor/README.md")))
    assert set(listed) == {"uPlot.iife.min.js", "uPlot.min.css"}
    for name, digest in listed.items():
        assert hashlib.sha256(_file(f"vendor/{name}").encode()).hexdigest() == digest


def test_a_page_that_is_too_large_to_be_sent_says_what_to_do(results, tmp_path, monkeypatch):
    assert write_page([results], tmp_path / "page.html") is None
    monkeypatch.setattr("mfr_bench.page.write.MOST_BYTES", 2**20 // 64)
    line = write_page([results], tmp_path / "page.html")
    assert line.startswith(f"{tmp_path / 'page.html'}: ") and "report fewer folders at a time" in line
