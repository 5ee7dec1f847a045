"""The JSON Schema for editors: it takes every shipped config, refuses planted mistakes, and is the file beside them."""

import copy
import json

import jsonschema
import pytest
import yaml

from mfr_bench.config import load, shipped, stress_configs
from mfr_bench.config.editor import editor_schema
from mfr_bench.methods import catalog
from mfr_bench.plan import expand
from mfr_bench.resources import configs_dir
from mfr_bench.run.jobs import jobs

DEVICE = {"renderer": "a device", "version": "4.5"}


@pytest.fixture(scope="module")
def schema():
    return editor_schema(catalog())


@pytest.fixture(scope="module")
def validator(schema):
    cls = jsonschema.validators.validator_for(schema)
    cls.check_schema(schema)
    return cls(schema)


def everything():
    return shipped() | stress_configs()


@pytest.mark.parametrize("name", everything())
def test_every_shipped_config_is_valid_and_names_the_schema(validator, name):
    path = everything()[name]
    assert [error.message for error in validator.iter_errors(yaml.safe_load(path.read_text()))] == []
    first = path.read_text().splitlines()[0]
    assert first.startswith("# yaml-language-server: $schema=")
    assert (path.parent / first.partition("=")[2]).resolve() == (configs_dir() / "schema.json").resolve()


def test_the_file_beside_the_configs_is_what_the_command_prints(schema):
    assert json.loads((configs_dir() / "schema.json").read_text()) == schema, (
        "configs/schema.json is out of date: mfr-bench schema --out configs/schema.json")


GOOD = {"name": "good", "scene": {"size": [64, 48], "depth_complexity": 8, "alpha": [0.1, 0.6]}, "params": {"k": 8},
        "methods": ["ab-array", {"id": "kplus-array", "label": "no culling", "culling": False}],
        "sweep": {"k": [4, 8], "scene.pixel_density": [0.5, 1.0]},
        "measure": {"time_limit_s": 1}, "figures": [{"kind": "lines", "x": "k", "y": "time_ms", "log": "xy"}]}


def test_a_good_config_is_valid(validator):
    assert list(validator.iter_errors(GOOD)) == []


@pytest.mark.parametrize(("path", "value"), [
    (("nmae",), "x"), (("name",), 3), (("methods",), []), (("methods", 0), "ab-aray"),
    (("methods", 1, "culing"), "off"), (("methods", 1, "culling"), "perhaps"), (("methods", 1, "id"), "no-method"),
    (("params", "k"), 0), (("params", "k"), "many"), (("params", "kk"), 8), (("sweep", "k"), []),
    (("sweep", "k", 0), 0), (("sweep", "scene.pixel_density", 0), 1.5), (("sweep", "scene.pixl_density"), [1]),
    (("scene", "size"), [64]), (("scene", "size", 0), 20000), (("scene", "pixel_density"), 0),
    (("scene", "kind"), "quad"), (("scene", "pixl_density"), 1), (("scene", "fragment_probability"), 2),
    (("measure", "target_rel_ci"), 1.5), (("measure", "time_limit"), 1), (("figures", 0, "kind"), "line"),
    (("figures", 0, "log"), "z"), (("figures", 0, "colour"), "red"),
], ids=lambda value: ".".join(map(str, value)) if isinstance(value, tuple) else str(value))
def test_a_planted_mistake_is_underlined(validator, path, value):
    wrong = copy.deepcopy(GOOD)
    at = wrong
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    errors = list(validator.iter_errors(wrong))
    assert errors
    assert all(list(path)[:len(e.absolute_path)] == list(e.absolute_path) for e in errors)


def test_every_parameter_and_every_key_is_explained(schema):
    for method in catalog().values():
        entry = schema["$defs"][f"method {method.id}"]
        assert set(entry["properties"]) == {"id", "label", *(p.name for p in method.params)}
        assert all("description" in entry["properties"][p.name] for p in method.params)


def test_a_comment_changes_no_key(tmp_path):
    """The line that names the schema, and any other comment: what is measured keeps its name."""
    path = tmp_path / "mine.yaml"
    keys = []
    for comment in ("", "# yaml-language-server: $schema=schema.json\n# another\n"):
        path.write_text(comment + yaml.safe_dump(GOOD))
        experiment, = load(str(path), catalog())
        keys.append([job.key for job in jobs(expand(experiment, catalog()), catalog(), DEVICE, "wall")])
    assert keys[0] == keys[1] and keys[0]
