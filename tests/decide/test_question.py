"""The question to decide: parsed, or refused in a line that says what is allowed."""

from fnmatch import fnmatch
from pathlib import Path

import numpy as np
import pytest

import mfr_bench
from mfr_bench.cli.mesh_scene import fragment_overrides, mesh_overrides
from mfr_bench.decide.candidates import candidates, within_time
from mfr_bench.decide.experiment import config_of, scene_of
from mfr_bench.decide.model import enough_layers
from mfr_bench.decide.question import Question, parsed_duration, parsed_error, parsed_size
from mfr_bench.errors import UsageError
from mfr_bench.methods import catalog
from mfr_bench.oracle.composite import composite

from ..methods.drawing import stack

ASKED = Question((64, 48), 24, 0.3)


@pytest.mark.parametrize(("parse", "text", "value"), [
    (parsed_size, "1280x720", (1280, 720)), (parsed_error, "1/255", 1 / 255), (parsed_error, "0.01", 0.01),
    (parsed_duration, "90s", 90.0), (parsed_duration, "2m", 120.0), (parsed_duration, "1.5h", 5400.0),
])
def test_words_are_parsed(parse, text, value):
    assert parse(text) == value


@pytest.mark.parametrize(("parse", "text"), [
    (parsed_size, "1280"), (parsed_size, "0x5"), (parsed_size, "99999x9"), (parsed_error, "1/0"), (parsed_error, "2"),
    (parsed_error, "nan"), (parsed_error, "low"), (parsed_duration, "2"), (parsed_duration, "0s"),
    (parsed_duration, "2d"),
])
def test_bad_words_are_one_line_with_what_is_allowed(parse, text):
    with pytest.raises(UsageError, match=r"^--[a-z-]+: .*; allowed: ") as error:
        parse(text)
    assert len(error.value.lines) == 1


def test_exact_answers_come_from_methods_that_promise_them():
    found, excluded = candidates(catalog(), ASKED)
    assert {each.method for each in found} | {each.method for each in excluded} == set(catalog()) - {"floor"}
    for each in found:
        variant = catalog()[each.method].variant(each.params)
        assert variant.guarantee.startswith("exact")
        assert variant.layers is None or variant.layers >= ASKED.layers
    assert {"wboit", "zbuffer", "kb"} <= {each.method for each in excluded}
    assert all(each.reason for each in excluded)


def test_an_error_lets_fewer_layers_and_approximate_methods_in():
    found, excluded = candidates(catalog(), Question((64, 48), 24, 0.3, max_error=1 / 255), enough=9)
    assert {each.params["k"] for each in found if "k" in each.params} == {9}
    assert {"wboit", "mlab", "kb"} <= {each.method for each in found}
    assert {"max_error": 1 / 255} in [each.params for each in found if each.method == "adaptive"]
    assert [each.method for each in excluded] == ["zbuffer"]


@pytest.mark.parametrize(("memory_mb", "named"), [(None, []), (64, [64.0]), (2**24, [pytest.approx(2**20)])])
def test_a_memory_lets_in_the_method_that_keeps_it_by_a_parameter(memory_mb, named):
    """The method might be over budget by its defaults where it need not be; its parameter takes less than 2**20 MiB."""
    found, _ = candidates(catalog(), Question((64, 48), 24, memory_mb=memory_mb))
    mine = [each for each in found if each.method == "adaptive"]
    assert mine[0].params == {}
    assert [each.params["memory_mb"] for each in mine if "memory_mb" in each.params] == named


def test_without_a_model_of_the_scene_several_k_are_tried():
    found, _ = candidates(catalog(), Question((64, 48), 24, max_error=0.1))
    assert [each.params["k"] for each in found if each.method == "kplus-heap" and "sort" not in each.params] == [
        2, 4, 8, 16, 24]


def test_little_time_leaves_each_method_its_first_candidate_before_any_its_second():
    found, excluded = candidates(catalog(), ASKED)
    kept, out = within_time(found, excluded, 30.0)
    assert 2 <= len(kept) < len(found) and len({each.method for each in kept}) == len(kept)
    assert len(kept) + len(out) == len(found) + len(excluded)
    assert "time budget" in out[-1].reason


def test_candidates_that_the_plan_forbids_take_no_room_from_others():
    found, excluded = candidates(catalog(), ASKED)
    forbidden = {each.label for each in found[:-3]}
    kept, out = within_time(found, excluded, 5.0, forbidden)
    assert {each.label for each in kept} == {each.label for each in found} and out == excluded
    kept, out = within_time(found, excluded, 2.0, forbidden)
    assert len(kept) == len(forbidden) + 2 and len(kept) + len(out) == len(found) + len(excluded)


@pytest.mark.parametrize("max_error", [0.3, 0.05, 1 / 255])
def test_enough_layers_is_the_least_number_that_keeps_the_error(max_error):
    scene = stack([i / 16 for i in range(1, 13)], [(200, 100, 50, 80)] * 12)
    enough = enough_layers(scene, max_error)
    errors = [abs(composite(scene, k) - composite(scene)).max() for k in range(1, 13)]
    assert errors[enough - 1] <= max_error and (enough == 1 or errors[enough - 2] > max_error)


def test_the_config_of_a_question_has_one_name_whatever_the_time():
    found, _ = candidates(catalog(), ASKED)
    one, other = (config_of(ASKED, scene_of(ASKED), found, left_s) for left_s in (30.0, 300.0))
    assert one["name"] == other["name"] and one["measure"]["time_limit_s"] < other["measure"]["time_limit_s"]
    assert config_of(Question((64, 48), 23), scene_of(ASKED), found, 30.0)["name"] == one["name"]
    assert config_of(Question((64, 48), 24, memory_mb=8), scene_of(ASKED), found, 30.0)["name"] != one["name"]


def test_git_ignores_answers_about_scenes_of_ones_own(tmp_path):
    """They would stand untracked beside the committed results."""
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    np.savez(tmp_path / "a.npz", viewport=(1, 1), pixel=np.zeros((1, 2), np.int32), depth=np.float32([0.5]),
             rgba=np.zeros((1, 4), np.uint8))
    named = [overrides(str(tmp_path / name))[0].removeprefix("name=")
             for overrides, name in ((mesh_overrides, "a.obj"), (fragment_overrides, "a.npz"))]
    named.append(config_of(ASKED, scene_of(ASKED), (), 1.0)["name"])
    ignored = (Path(mfr_bench.__file__).parents[1] / ".gitignore").read_text().split("\n")
    for name in named:
        assert any(fnmatch(f"/results/some-device/{name}/", pattern) for pattern in ignored), name
