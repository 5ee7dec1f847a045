"""The configs against the table of the papers' settings."""

from __future__ import annotations

import re
from functools import cache

import pytest
import yaml

from mfr_bench.config import load, shipped
from mfr_bench.methods import catalog
from mfr_bench.plan import expand
from mfr_bench.report.settings import settings, value_of

PAPERS = r"(gpupro5_ch[12]|kplus_2014_slides|kplus_2015|occupancy_2015|sbuffer_2012):\d+(-\d+)?(,\d+(-\d+)?)*"
HELD = [row for row in settings() if row.key]
# The keys that a profile of a smaller viewport changes, since it has fewer pixels and so less memory.
BY_PIXELS = {"scene.size", "scene.quad_size", "measure.memory_budget_mb", "memory_mb"}


@cache
def experiment(name: str, profile: str | None):
    loaded, = load(str(shipped()[name]), catalog(), profile)
    return loaded, expand(loaded, catalog())


def told(row) -> str:
    return f"{row.of}: {row.setting}"


@pytest.mark.parametrize("row", HELD, ids=told)
def test_the_config_has_what_the_table_says(row):
    assert value_of(row.key, *experiment(row.of, None)) == row.here


@pytest.mark.parametrize("row", [row for row in HELD if row.key not in BY_PIXELS], ids=told)
def test_the_profile_smoke_keeps_the_setting(row):
    """All of it, or some of the values along an axis, the first among them."""
    full, smoke = (value_of(row.key, *experiment(row.of, profile)).split("; ") for profile in (None, "smoke"))
    assert set(smoke) <= set(full)
    assert len(full) == 1 or len(smoke) > 1
    assert smoke[0] == full[0]


def test_every_experiment_and_no_setting_twice():
    of_papers = {name for name in shipped() if experiment(name, None)[0].source.get("paper")}
    of_papers -= {"sorts"}  # of no figure: it sets the sorts of several papers side by side
    named = {row.of for row in settings()}
    assert of_papers <= named
    assert named - of_papers <= set(catalog())
    places = [(row.of, row.setting) for row in settings()]
    assert len(set(places)) == len(places), {place for place in places if places.count(place) > 1}


@pytest.mark.parametrize("row", settings(), ids=told)
def test_a_difference_has_a_reason_and_an_effect(row):
    """A setting that is not printed, or not so, says why it is as it is, and what that favours."""
    assert re.fullmatch(PAPERS, row.place), row.place
    assert bool(row.reason) == bool(row.effect)
    assert row.reason or row.printed
    assert row.here


def test_the_methods_of_every_experiment_are_held():
    named = {row.of for row in settings()} - set(catalog())
    assert {row.of for row in settings() if row.key == "methods"} == named


UNPRINTED = {"seed", "kind", "colours"}  # of a scene; what stands in for a model is stated with the layout or the mean


def set_by(name: str) -> set[str]:
    """The keys of the table for all that a config sets: of its scene, its parameters, its axes and its series."""
    config = yaml.safe_load(shipped()[name].read_text())
    axes = {key for part in ("params", "sweep", "zip") for key in config.get(part) or {}}
    series = {key for entry in config["methods"] if isinstance(entry, dict) for key in entry} - {"id", "label"}
    return ({f"scene.{key}" for key in config["scene"]} | axes | series) - {f"scene.{key}" for key in UNPRINTED}


@pytest.mark.parametrize("name", sorted({row.of for row in settings()} - set(catalog())))
def test_nothing_that_a_config_sets_is_untold(name):
    held = {row.key.rpartition("] ")[2] for row in settings() if row.of == name and row.key}
    assert set_by(name) <= held
