"""Configs as they are loaded: defaults, precedence, profiles, overrides, and how files are found."""

from pathlib import Path

import pytest

from mfr_bench import config
from mfr_bench.config import Measure, MethodEntry
from mfr_bench.errors import UsageError
from mfr_bench.methods import catalog

from .conftest import GOOD
from .fakes import CATALOG


def test_defaults_fill_what_a_config_leaves_out(load):
    experiment = load("name: a\nscene: {size: [8, 4], depth_complexity: 0}\nmethods: [ab-array]\n")
    assert experiment.title == "a"
    assert experiment.scene.as_dict() == {
        "kind": "quads", "size": [8, 4], "pixel_density": 1.0, "depth_complexity": 0, "mean_depth": None,
        "layout": "block", "order": "random", "slant": 0.0, "alpha": [0.1, 0.6], "colours": "any",
        "fragment_probability": 1.0, "seed": 1, "animate": False,
        "quad_size": None, "depth_at": None, "depth_gap_log2": -4, "depth_copies": 1, "copies": "alike",
        "odd_depth": "none", "alpha_order": "random", "overhang": 0}
    assert experiment.measure == Measure()
    assert experiment.methods == (MethodEntry("ab-array", "AB_Array", {}),)
    assert (experiment.sweep, experiment.zip, experiment.figures, experiment.source) == ({}, {}, (), {})


def test_one_alpha_is_both_bounds(load):
    assert load(GOOD.replace("size", "alpha: 0.5, size", 1)).scene.alpha == (0.5, 0.5)


def test_bare_booleans_are_on_and_off(load):
    entries = "[{id: kplus-array, culling: off}, {id: kplus-heap, culling: yes}]"
    experiment = load(GOOD.replace("[kplus-array, ab-array]", entries) + "params: {culling: no}\n")
    assert [e.params for e in experiment.methods] == [{"culling": "off"}, {"culling": "on"}]
    assert experiment.params == {"culling": "off"}


def test_yaml_exponents_are_numbers(load):
    assert load(GOOD + "measure: {target_rel_ci: 1e-3}\n").measure.target_rel_ci == 0.001


def test_real_parameters_take_any_number_between_their_bounds(load):
    text = GOOD.replace("ab-array", "open-post") + "params: {load_factor: 0.95}\n"
    assert load(text).params == {"load_factor": 0.95}


def test_merge_keys_and_anchors_work(load):
    text = GOOD.replace("measure", "m") + "measure: &m {min_samples: 3}\n"
    text = text.replace("  smoke:", "  base: &b {scene.seed: 9}\n  smoke: {<<: *b}\n  other:")
    assert load(text, "smoke").scene.seed == 9


def test_a_profile_overrides_dotted_keys(load):
    experiment = load(profile="smoke")
    assert experiment.scene.size == (16, 16)
    assert experiment.sweep == {"k": (2,)}


def test_overrides_come_after_the_profile(load):
    experiment = load(profile="smoke", overrides=["scene.size=[5, 7]", "measure.min_samples=3"])
    assert experiment.scene.size == (5, 7)
    assert experiment.measure.min_samples == 3


def test_fixing_a_parameter_ends_its_sweep(load):
    experiment = load(overrides=["k=8"])
    assert experiment.params == {"k": 8}
    assert experiment.sweep == {}


def test_fixing_a_scene_key_ends_its_sweep(load):
    text = GOOD.replace("{k: [4, 16]}", "{k: [4, 16], scene.seed: [1, 2]}")
    assert load(text, overrides=["scene.seed=5"]).sweep == {"k": (4, 16)}


def test_a_fixed_scene_key_stays_the_axis_that_a_figure_draws_along(load):
    text = GOOD.replace("{k: [4, 16]}", "{k: [4, 16], scene.seed: [1, 2]}").replace("x: k", "x: scene.seed")
    experiment = load(text, overrides=["scene.seed=5"])
    assert experiment.sweep == {"k": (4, 16), "scene.seed": (5,)} and experiment.scene.seed == 5


@pytest.mark.parametrize(("fixed", "expected"), [
    ("scene.seed=2", {"scene.size": ((3, 4),), "scene.alpha": ((0.2, 0.2),)}),
    ("scene.size=[1, 2]", {"scene.seed": (1, 5), "scene.alpha": ((0.1, 0.1), (0.5, 0.5))}),
    ("scene.seed=9", {"scene.size": ((1, 2), (3, 4), (1, 2)), "scene.alpha": ((0.1, 0.1), (0.2, 0.2), (0.5, 0.5))}),
])
def test_fixing_a_zipped_key_keeps_the_points_that_have_its_value(load, fixed, expected):
    zipped = "zip: {scene.seed: [1, 2, 5], scene.size: [[1, 2], [3, 4], [1, 2]], scene.alpha: [0.1, 0.2, 0.5]}\n"
    assert load(GOOD + zipped, overrides=[fixed]).zip == expected


@pytest.mark.parametrize("fixed", ["layers", "csg", "transparency"])
def test_an_effect_of_many_may_be_fixed(fixed):
    """It brings the layer and the operation that the config has beside it."""
    [experiment] = config.load("effects", catalog(), "smoke", overrides=[f"scene.effect={fixed}"])
    assert experiment.sweep["scene.effect"] == (fixed,)
    assert experiment.zip["scene.operation"] == (("difference",) if fixed == "csg" else ("union",))


def test_fixing_the_depth_complexity_ends_r(load):
    experiment = load(GOOD + "params: {r: 2}\n", overrides=["scene.depth_complexity=5"])
    assert experiment.params == {}
    assert experiment.scene.depth_complexity == 5


def test_a_layer_may_fix_a_key_that_it_also_sweeps(load):
    text = GOOD.replace("sweep.k: [2]", "sweep.k: [2], params.k: 3")
    assert load(text, "smoke").sweep == {"k": (2,)}


def test_r_needs_no_depth_complexity(load):
    text = GOOD.replace(", depth_complexity: 32", "") + "params: {r: 3}\n"
    assert load(text).scene.depth_complexity == 12


def test_swept_scene_values_become_canonical(load):
    experiment = load(GOOD + "zip: {scene.size: [[1, 2], [3, 4]], scene.alpha: [0.5, [0.1, 0.2]]}\n")
    assert experiment.zip == {"scene.size": ((1, 2), (3, 4)), "scene.alpha": ((0.5, 0.5), (0.1, 0.2))}


def test_entries_of_one_label_are_fine_where_they_make_the_same_cells(load):
    text = GOOD.replace("sweep: {k: [4, 16]}", "params: {k: 8}").replace("sweep.k: [2]", "").replace("x: k", "x: seed")
    assert len(load(text.replace("ab-array", "{id: kplus-array, k: 8}")).methods) == 2


def test_a_folder_is_its_files_in_order(write):
    write(GOOD.replace("good", "second"), "b.yaml")
    path = write(GOOD.replace("good", "first"), "a.yml")
    write("not a config", "notes.txt")
    assert [e.name for e in config.load(str(path.parent), CATALOG)] == ["first", "second"]


def test_files_of_a_folder_need_names_of_their_own(write):
    write("# a comment\n" + GOOD, "b.yaml")
    path = write(GOOD, "a.yaml")
    with pytest.raises(UsageError, match=r"b.yaml:2: name: 'good' is also the name in .*a.yaml"):
        config.load(str(path.parent), CATALOG)


@pytest.mark.parametrize("name", sorted(config.shipped()))
def test_shipped_configs_load_with_every_profile(name):
    profiles = [None, "smoke"]
    for profile in profiles:
        [experiment] = config.load(name, catalog(), profile)
        assert experiment.name == name == experiment.path.stem


@pytest.mark.parametrize(("reference", "message"), [
    ("nowhere/x.yaml", "nowhere/x.yaml: no such file or folder"),
    ("smok", "nearest: 'smoke'"),
    ("smok", "no such file, folder or shipped config; nearest: 'smoke', '.*'; allowed: any of"),
    ("a\0b", "no such file, folder or shipped config"),
    ("x" * 5000, "too long"),
])
def test_what_cannot_be_found_is_said_in_one_line(reference, message):
    with pytest.raises(UsageError, match=message) as caught:
        config.load(reference, CATALOG)
    assert len(caught.value.lines) == 1


def test_a_folder_without_configs(tmp_path):
    with pytest.raises(UsageError, match="a folder without configs"):
        config.load(str(tmp_path), CATALOG)


def test_a_file_that_cannot_be_read(tmp_path, monkeypatch):
    def refuse(self):
        raise PermissionError(13, "Permission denied")
    path = tmp_path / "a.yaml"
    path.write_text(GOOD)
    monkeypatch.setattr(Path, "read_bytes", refuse)
    with pytest.raises(UsageError, match=r"a.yaml:1: cannot be read: Permission denied$"):
        config.load(str(path), CATALOG)


def test_a_file_that_is_not_text(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_bytes(b"name: a\n\xff\xfe")
    with pytest.raises(UsageError, match=r"a.yaml:2: not UTF-8 text$"):
        config.load(str(path), CATALOG)


def test_the_json_schema_knows_every_key():
    properties = config.schema()["properties"]
    assert {"name", "scene", "methods", "sweep", "zip", "figures", "profiles"} <= set(properties)
    assert "depth_complexity" not in config.schema()["$defs"]["Scene"]["required"]
    numbers = config.schema()["$defs"]["Scene"]["properties"]["alpha"]["anyOf"][0]
    assert {"type": "number"}.items() <= numbers["anyOf"][0].items()


@pytest.mark.parametrize("module", ["mfr_bench.config", "mfr_bench.plan"])
def test_imports_stay_light(module):
    """Only reading a config pays for pydantic, and nothing here for numpy or GL."""
    import subprocess
    import sys
    code = f"import sys, {module}; print([m for m in ('pydantic', 'numpy', 'pandas', 'moderngl') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_all_stands_for_every_method(load):
    experiment = load(GOOD.replace("ab-array]", "all]").replace("[kplus-array, all", "[all, "
                                   "{id: kplus-array, label: no culling, culling: off}"))
    assert [e.id for e in experiment.methods] == [*CATALOG, "kplus-array"]
    assert experiment.methods[-1].label == "no culling"


def test_whole_numbers_are_decimal(load):
    """010 is ten, not the eight of YAML 1.1, and 1:30 is no number."""
    experiment = load(GOOD.replace("depth_complexity: 32", "depth_complexity: 010, seed: 0x10"))
    assert (experiment.scene.depth_complexity, experiment.scene.seed) == (10, 16)
