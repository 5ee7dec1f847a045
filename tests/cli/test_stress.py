"""`stress`: the shipped stressors, found by name, measured, and told by where they break."""

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


def test_a_dry_run_measures_nothing(mfr, here):
    ended = mfr("stress", "depth-gap", "reach", "--only", "kb-mdt32", "--profile", "smoke", "--dry-run")
    assert ended.status == 0
    assert ended.out.startswith("stress-depth-gap: ")
    assert "\n\nstress-reach: " in ended.out
    assert " cells to measure in all: " in ended.out
    assert not (here / "results").exists()
