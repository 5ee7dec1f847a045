"""`stress`: the shipped stressors, found by name, measured, and told by where they break."""

import json
import re

import pytest

from mfr_bench.config import load, stress_configs
from mfr_bench.methods import catalog
from mfr_bench.plan import expand

from .conftest import rows

pytestmark = pytest.mark.usefixtures("on_device")

CELLS_OF_A_METHOD = 9.3  # at most, in the mean, so that each new method costs a stressor as much as the others do


@pytest.mark.parametrize("name", sorted(stress_configs()))
def test_every_stressor_goes_from_mild_to_harsh(name):
    """A figure of kind `breaking` along an axis of the config, in every profile; small enough for minutes."""
    for profile in (None, "smoke"):
        (experiment,) = load(str(stress_configs()[name]), catalog(), profile)
        assert experiment.name == f"stress-{name}"
        drawn = [figure for figure in experiment.figures if figure.kind == "breaking"]
        assert drawn
        assert all(figure.x in {**experiment.sweep, **experiment.zip} for figure in drawn)
    assert len(expand(experiment, catalog())) <= CELLS_OF_A_METHOD * len(catalog())


def test_the_list_names_them(mfr):
    ended = mfr("stress", "--list")
    assert ended.status == 0
    assert [line.split()[0] for line in ended.out.splitlines()] == list(stress_configs())


def test_a_name_that_is_none_gets_the_nearest(mfr):
    ended = mfr("stress", "depth-gpa")
    assert ended.status == 2
    assert ended.complaint.startswith("mfr-bench stress: Invalid value for '[NAME...]': no stressor 'depth-gpa'; "
                                      "allowed: accumulation, ")
    assert "nearest: 'depth-gap'" in ended.err


def test_a_break_is_a_result_and_no_failure(mfr, here):
    """Keys of 24 bits collide where the gap is finer; keys of float bits do not. The exit status is 0 all the same."""
    ended = mfr("stress", "depth-gap", "--only", "kb-mdt32,peel-f2b", "--profile", "smoke", "--out", "s",
                "--set", "scene.size=[4,3]")
    assert ended.status == 0
    coarse, fine = ([line for line in ended.out.splitlines() if line.split("  ")[0] == label]
                    for label in ("KB-MDT_32 (24-bit keys)", "KB-MDT_32"))
    assert "-24: differs, error" in coarse[0]
    assert fine
    assert all("holds up to -" in line for line in fine)
    assert {r["status"] for r in rows(here / "s" / "results.csv")} == {"ok"}
    assert (here / "s" / "figures" / "stress-depth-gap.png").exists()


def test_a_wrong_image_is_told_and_is_no_failure(mfr, plant):
    plant("methods/peel/f2b.frag", "gl_FragCoord.z <= ", "gl_FragCoord.z < ")
    ended = mfr("stress", "odd-depths", "--only", "peel-f2b", "--profile", "smoke", "--out", "s",
                "--set", "scene.size=[4,3]", "--set", "sweep.scene.odd_depth=[none]")
    assert ended.status == 0
    assert "none: " in ended.out
    assert " 1 wrong" in ended.out


def test_a_budget_is_shared_by_all_stressors(mfr, here, monkeypatch):
    """One of fourteen took all of it, and nothing said so. The time is up after a few cells of each."""
    only, names = ("--only", "peel-f2b,peel-dual,ab-array,ab-ll,ab-sb"), ("depth-gap", "slant")
    from mfr_bench.run.supervisor import Supervisor

    left = [5]
    monkeypatch.setattr(Supervisor, "_late", property(lambda self: left[0] <= 0))
    measure_group = Supervisor._measure_group

    def counted(self, group, *more):
        left[0] -= 1
        return measure_group(self, group, *more)

    monkeypatch.setattr(Supervisor, "_measure_group", counted)
    ended = mfr("stress", *names, *only, "--profile", "smoke", "--out", "s", "--time-budget", "1h")
    assert ended.status == 0
    found = {name: rows(here / "s" / f"stress-{name}" / "results.csv") for name in names}
    assert all(found.values()) and len({row["method"] for row in found["slant"]}) >= 3
    line, = (line for line in ended.out.splitlines() if re.match(r"left out for the time budget: \d+ of", line))
    planned = sum(len(json.loads((here / "s" / f"stress-{name}" / "manifest.json").read_text())["cells"])
                  for name in names)
    done = sum(map(len, found.values()))
    assert line == (f"left out for the time budget: {planned - done} of {planned} cells, of 2 of 2 configs; the same "
                    "command measures them")
    assert " not measured)" in ended.out and "left out for the time budget" in ended.out.partition("First level")[2]


def test_cells_that_nothing_can_measure_are_not_left_out_for_the_time(mfr, here, monkeypatch):
    """The dry run and the run count the same cells; those that device or memory forbids need no time."""
    arguments = ("stress", "slant", "reach", "--only", "peel-f2b,open-post,ab-array", "--profile", "smoke",
                 "--out", "s", "--set", "measure.memory_budget_mb=0.02", "--time-budget")
    planned = mfr(*arguments, "1h", "--dry-run")
    assert planned.out.endswith("all of it should fit the time budget of 1 h 00 min\n")
    refused = planned.out.count(" unsupported: ") + planned.out.count(" over_budget: ")
    measurable = planned.out.count("  measure\n")
    monkeypatch.setattr("mfr_bench.cli.session.Session._deadlines", lambda *_: (0.0, float("inf")))
    ended = mfr(*arguments, "1h")
    assert refused > 0 < measurable
    assert f"left out for the time budget: {measurable} of {measurable} cells, of 2 of 2 configs" in ended.out
    told = re.findall(r"(\d+) planned cells have no record yet, left out for the time budget; (\d+) of them cannot be",
                      " ".join(ended.out.split()))
    assert sum(int(count) for count, _ in told) == measurable + refused
    assert sum(int(count) for _, count in told) == refused


def test_a_dry_run_measures_nothing(mfr, here):
    ended = mfr("stress", "depth-gap", "reach", "--only", "kb-mdt32", "--profile", "smoke", "--dry-run")
    assert ended.status == 0
    assert ended.out.startswith("stress-depth-gap: ")
    assert "\n\nstress-reach: " in ended.out
    assert " cells to measure in all: " in ended.out
    assert not (here / "results").exists()
