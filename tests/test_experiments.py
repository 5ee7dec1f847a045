"""The experiments of the papers: every config is there, loads in both profiles, and its figures can be drawn."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from mfr_bench.claims import CLAIMS, load_runs
from mfr_bench.config import load
from mfr_bench.methods import catalog
from mfr_bench.plan import expand
from mfr_bench.report import data, figures
from mfr_bench.report.reference import find
from mfr_bench.scene.spec.values import told
from mfr_bench.store.arrays import write_arrays

from .report import planted

ROOT = Path(__file__).parents[1]
EXPERIMENTS = (
    "sbuffer2012-fig2", "sbuffer2012-fig3", "sbuffer2012-fig4", "sbuffer2012-referencing", "sbuffer2012-memory",
    "kplus2014-k", "kplus2014-sorting", "kplus2014-memory", "kplus2014-abuffer", "kplus2014-quality",
    "kplus2014-applications",
    "kplus2015-table1", "kplus2015-fig3", "kplus2015-fig4", "kplus2015-fig6", "kplus2015-fig7", "kplus2015-fig8",
    "kplus2015-fig8-full", "kplus2015-zbuffer", "kplus2015-generic",
    "kplus2015-fig9-sync", "kplus2015-fig9-abuffer", "kplus2015-fig10", "kplus2015-lsort",
    "gpupro5-fig1", "gpupro5-cas", "gpupro5-allocation", "gpupro5-renders",
    "gpupro5-fig3", "gpupro5-fig4", "gpupro5-fig5", "gpupro5-fig6", "gpupro5-fig7", "gpupro5-local-array",
    "occupancy2015-fig1", "occupancy2015-fig4", "occupancy2015-fig5", "twochannel-fig4",
)


@pytest.fixture(autouse=True)
def _no_wait_for_the_disk(monkeypatch):
    monkeypatch.setattr(os, "fsync", lambda _: None)


@cache
def experiment(name: str, profile: str | None = None):
    loaded, = load(str(ROOT / "configs" / f"{name}.yaml"), catalog(), profile)
    return loaded


def test_all_experiments_have_a_config():
    """Others may come from a paper, too; what the claims need is among these."""
    of_papers = {path.stem for path in (ROOT / "configs").glob("*.yaml") if experiment(path.stem).source.get("paper")}
    assert set(EXPERIMENTS) <= of_papers and len(set(EXPERIMENTS)) == len(EXPERIMENTS)
    assert {name for claim in CLAIMS for name in claim.experiments} <= set(EXPERIMENTS)


def test_the_page_is_what_the_configs_give():
    shown = subprocess.run([sys.executable, "-m", "mfr_bench", "configs", "--markdown"], capture_output=True, text=True,
                           check=True).stdout
    assert (ROOT / "docs" / "experiments.md").read_text() == shown, (
        "docs/experiments.md is out of date: mfr-bench configs --markdown >docs/experiments.md")


def test_the_page_of_differences_is_what_settings_and_claims_give():
    shown = subprocess.run([sys.executable, "-m", "mfr_bench", "configs", "--fidelity"], capture_output=True, text=True,
                           check=True).stdout
    assert (ROOT / "docs" / "fidelity.md").read_text() == shown, (
        "docs/fidelity.md is out of date: mfr-bench configs --fidelity >docs/fidelity.md")


LONGEST_LABEL = 40  # letters: a longer one takes more room under a bar than the bar has above it


def test_labels_have_room_under_a_bar():
    labels = {method.label for path in sorted((ROOT / "configs").glob("*.yaml"))
              for method in experiment(path.stem).methods}
    assert [label for label in sorted(labels) if len(label) > LONGEST_LABEL] == []


@pytest.mark.parametrize("path", [path for path in sorted((ROOT / "configs").rglob("*.yaml"))
                                  if not path.stem.startswith("gpupro5-")], ids=lambda path: path.stem)
def test_what_is_emulated_says_so_in_its_name(path):
    """But in GPU Pro 5's own experiments, whose methods of these names are the emulated ones (§1.6)."""
    for profile in (None, "smoke"):
        loaded, = load(str(path), catalog(), profile)
        for entry in loaded.methods:
            emulated = entry.params.get("atomic64") == "emulated"
            assert emulated == ("emulated" in entry.label), entry


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_it_loads_in_both_profiles_under_its_own_name(name):
    """At full size in the paper's viewport, in the profile smoke in one of at most a hundredth of its pixels."""
    full, smoke = experiment(name), experiment(name, "smoke")
    assert full.name == smoke.name == name and full.figures
    pixels = [max(c.scene.size[0] * c.scene.size[1] for c in expand(e, catalog())) for e in (full, smoke)]
    assert pixels[0] >= 854 * 480 and pixels[1] * 50 <= pixels[0]


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_the_printed_numbers_that_it_asks_for_are_there(name):
    source = experiment(name).source
    for quantity in source.get("prints") or ():
        assert find(paper=source["paper"], quantity=quantity), (name, quantity)


def told_in(values):
    """Values by name as records have them."""
    return {name: told(value) for name, value in values.items()}


def made_up(name: str, profile: str | None = "smoke"):
    """A record for each cell, with values that grow with what usually costs time."""
    for i, c in enumerate(expand(experiment(name, profile), catalog())):
        scene, params = c.scene.as_dict(), dict(c.params)
        pixels = scene["size"][0] * scene["size"][1]
        layers = scene.get("depth_complexity", 8)  # those of a mesh are measured
        fragments = round(pixels * scene.get("pixel_density", 0.5) * layers * 0.9)
        time_ms = 1 + fragments / 1e5 + int(params.get("k") or 0) / 9 + i % 7 / 5
        passes = {p.name: time_ms / 3 for p in catalog()[c.method].variant(params).passes}
        frames = [{"frame": f, "fragments": 70, "chosen_k": 2 + f, "histogram": [40, 30, 20, 1 + f]} for f in range(3)]
        yield planted.cell(
            c.method, c.label, time_ms, passes, scene, params, told_in(c.point), experiment=name,
            measure=c.measure.as_dict(), frames=frames if "memory_mb" in params else [],
            values={"fragments": fragments, "covered_pixels": pixels, "max_fragments": layers,
                    "memory_bytes": 8 * fragments, "rmse": 0.01 * (1 + i % 3), "culled_share": 0.5,
                    "promised_ratio": 0.5, "hit_ratio": 0.5, "luminance_error": 0.001, "hue_error": 2.0,
                    "max_error_all": 0.01})


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.id)
def test_every_claim_finds_its_cells_in_a_config(tmp_path, claim):
    """Each rule has something to compare, and no method that it speaks of is missing, in each config that it names."""
    runs = [run for name in claim.experiments
            for run in load_runs([planted.folder(tmp_path / name, list(made_up(name, None)), name=name)])]
    for rule in claim.rules:
        compared = [c for run in runs for c in rule.compare(run)]
        assert compared, f"no cells of {rule.needs}"
        assert set(rule.each) <= {method for c in compared for method in c.at["methods"]}, rule.needs


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_its_figures_can_be_drawn_from_its_cells(tmp_path, name):
    """Every series is in a figure, and nothing is left undrawn."""
    whole = experiment(name, "smoke")
    cells = list(made_up(name))
    axes = {section: told_in(getattr(whole, section)) for section in ("sweep", "zip")}
    folder = planted.folder(tmp_path, cells, [f.as_dict() for f in whole.figures], name=name, source=dict(whole.source),
                            **axes)
    for record in cells:
        width, height = record["scene"]["size"]
        write_arrays(folder, record["key"], {kept: np.ones((height, width) + ((4,) if kept == "image" else ()))
                                             for kept in record["measure"]["keep"]})
    result = data.load(folder)
    for options in result.figures:
        figure = figures.build(result, options)
        said = " ".join(t.get_text() for t in figure.findobj(lambda a: hasattr(a, "get_text")))
        assert "not measured" not in said, (name, options)
        assert set(figures.render(figure)) == {"png", "svg"}


SHARING = (  # cells, at least
    ("kplus2015-fig6", "kplus2015-fig7", 12), ("sbuffer2012-fig4", "sbuffer2012-memory", 24),
    ("sbuffer2012-fig4", "sbuffer2012-referencing", 18), ("gpupro5-fig3", "gpupro5-local-array", 0),
)


@pytest.mark.parametrize("profile", [None, "smoke"])
@pytest.mark.parametrize(("one", "other", "cells"), SHARING)
def test_what_figures_share_is_the_same(one, other, cells, profile):
    """Fig. 7 asks for cells of Fig. 6, the S-buffer's experiments for each other's: measured once, they serve both."""
    sides = [expand(experiment(name, profile), catalog()) for name in (one, other)]
    alike = [{(c.method, str(sorted(c.params.items())), c.scene, c.measure) for c in side} for side in sides]
    assert {c.scene for c in sides[0]} & {c.scene for c in sides[1]}
    assert len(alike[0] & alike[1]) >= cells
