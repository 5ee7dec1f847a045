"""Any text either loads or is refused in lines that a user can read; what loads stays within the rules."""

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mfr_bench import config
from mfr_bench.errors import UsageError
from mfr_bench.scene.kinds import kind_of
from mfr_bench.scene.spec.kind import MAX_PRIMITIVES

from .conftest import GOOD
from .fakes import CATALOG

SLOW = settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])

WORDS = st.sampled_from(["name", "scene", "size", "methods", "sweep", "zip", "k", "r", "params", "profiles", "smoke",
                         "kplus-array", "floor", "scene.size", "sweep.k", "figures", "kind", "lines", "x", "id"])
LEAVES = st.one_of(WORDS, st.none(), st.booleans(), st.integers(-3, 2**33), st.floats(), st.text(max_size=5))
TREES = st.recursive(LEAVES, lambda inner: st.one_of(
    st.lists(inner, max_size=3), st.dictionaries(st.one_of(WORDS, st.text(max_size=3)), inner, max_size=4)),
    max_leaves=12)


def outcome(path, text, **more):
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        return config.load(str(path), CATALOG, **more)
    except UsageError as error:
        lines = error.lines
    assert lines
    assert all(line.isprintable() and line.startswith((str(path), "--set")) for line in lines)
    return None


@SLOW
@given(text=st.text(max_size=80))
def test_any_text_is_loaded_or_refused(tmp_path, text):
    outcome(tmp_path / "a.yaml", text)


@SLOW
@given(key=st.sampled_from(["scene", "methods", "params", "sweep", "zip", "measure", "figures", "profiles", "source"]),
       value=TREES)
def test_any_value_anywhere_is_loaded_or_refused(tmp_path, key, value):
    text = yaml.safe_dump(yaml.safe_load(GOOD) | {key: value}, allow_unicode=True)
    outcome(tmp_path / "a.yaml", text)


@SLOW
@given(override=st.one_of(st.text(max_size=20), st.builds("{}={}".format, WORDS, st.text(max_size=8)),
                          st.builds("scene.{}={}".format, WORDS, LEAVES)))
def test_any_override_is_loaded_or_refused(tmp_path, override):
    outcome(tmp_path / "a.yaml", GOOD, overrides=[override])


@SLOW
@given(width=st.integers(1, 16384), height=st.integers(1, 16384), density=st.floats(1e-3, 1), n=st.integers(0, 1024),
       layout=st.sampled_from(["block", "tiles", "random", "mixed"]), seed=st.integers(0, 2**32 - 1),
       alpha=st.tuples(st.floats(0.01, 0.5), st.floats(0.5, 1)))
def test_what_is_written_is_what_is_read(tmp_path, width, height, density, n, layout, seed, alpha):
    scene = {"kind": "quads", "size": [width, height], "pixel_density": density, "depth_complexity": n,
             "layout": layout, "order": "random", "alpha": list(alpha), "fragment_probability": 1.0, "seed": seed,
             "animate": False, "quad_size": None, "mean_depth": None, "slant": 0.25, "colours": "hues-4"}
    text = yaml.safe_dump({"name": "a", "scene": scene, "methods": ["floor"]})
    loaded = outcome(tmp_path / "a.yaml", text)
    if loaded:
        assert loaded[0].scene.as_dict().items() >= scene.items()
        assert kind_of(loaded[0].scene).primitives(loaded[0].scene) <= MAX_PRIMITIVES


@SLOW
@given(value=st.one_of(st.floats(), st.integers(-5, 5), st.booleans(), st.text(max_size=4), st.none()))
def test_a_share_is_a_number_above_0_up_to_1(tmp_path, value):
    text = yaml.safe_dump({"name": "a", "methods": ["floor"],
                           "scene": {"size": [8, 8], "depth_complexity": 1, "pixel_density": value}})
    good = not isinstance(value, bool) and isinstance(value, (int, float)) and 0 < value <= 1
    assert (outcome(tmp_path / "a.yaml", text) is not None) == good


@pytest.mark.parametrize("text", ['name: "\\ud800"', "name: 2015-13-45", "a: !!binary x", "? {a: b}\n: c", "<<: 5",
                                  "a: &x {<<: *x}", "name: " + "9" * 5000, "%YAML 9.9\n---\na: b", "a: !!set {b}",
                                  "&a a: *a", "name: *nowhere", "scene: &s {<<: [{size: [1, 1]}, 5]}"])
def test_odd_yaml_is_refused(tmp_path, text):
    assert outcome(tmp_path / "a.yaml", text) is None
