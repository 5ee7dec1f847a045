"""Trials of drivers: each sees the fault that it is there for, and a feature that fails its own counts as missing."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from mfr_bench.config import load
from mfr_bench.config.model import Measure
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.gpu import trials
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.pass_runner import PassRunner
from mfr_bench.gpu.single import shown
from mfr_bench.gpu.trials import TRIALS, Trial, failed
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import NEAREST_33, TILE_POINTS, Fitted
from mfr_bench.plan import Cell, Limits, expand, expected_stats, features_for, judge
from mfr_bench.scene import generate

BY_NAME = {trial.name: trial for trial in TRIALS}


def outcome(device, name):
    """Whether the trial passes; skips where the driver does not offer its feature."""
    trial = BY_NAME[name]
    if trial.feature and trial.feature not in device.offered:
        pytest.skip(f"this device lacks {trial.feature}")
    return trial.outcome(device)


@pytest.mark.parametrize(("name", "path", "right", "wrong", "said"), [
    ("atomic operations", "probe/operations.glsl", "atomicExchange(element[4], value)", "element[4] = value",
     "exchange"),
    ("atomic operations", "probe/operations.glsl", "atomicMin(element[2], value)", "atomicMax(element[2], value)",
     "min"),
    ("atomic operations", "probe/operations.glsl", "atomicCompSwap(element[5], 0u, value)",
     "atomicExchange(element[5], value)", "compare-and-swap"),
    ("atomic operations", "probe/operations.glsl", "atomicCounterIncrement(dedicated)", "value", "counter in"),
    ("atomic operations", "probe/operations.frag", "apply(p)", "apply(p / 2u)", "add in fragment shaders"),
    ("64-bit atomics", "probe/operations64.glsl", "packInt2x32(ivec2(value))", "int64_t(value.x)", "exchange"),
    ("64-bit atomics", "probe/operations64.glsl", "atomicMin(words64[1]", "atomicMin(words64[0]", "min"),
    ("64-bit atomics", "probe/operations64.glsl", "signed64[0],", "words64[0],", "no matching function"),
    ("blending", "probe/blend.frag", "0.25", "0.5", "rg8 add one one"),
    ("blending", "probe/blend.frag", "out_beside = vec4(vec3(0.25), 0.5)", "out_beside = vec4(0.25)", "r8 add zero"),
    ("queries", "common/count.frag", "void main() {", "void main() { if (gl_FragCoord.x < 1.0) discard;", "samples"),
    ("full registers", "probe/full_registers.comp", "nodes[at++]", "nodes[at]", "0 of 256 pixels right"),
    ("full registers", "probe/full_registers.comp", "COMPARE(0, 1) ", "COMPARE(1, 0) ",
     "GALLIUM_OVERRIDE_CPU_CAPS=avx"),
    ("block length", "probe/block_length.frag", "seen[p] = uint(second.length())", "seen[p] = 4u", "480 of 480"),
    ("primitive numbers", "probe/primitive_number.frag", "uint(gl_PrimitiveID)", "uint(gl_PrimitiveID) / 4u",
     "of 1440 fragments"),
    ("primitive numbers", "probe/numbered.vert", "place = vec2(", "place = vec2(0.1 + ", "0 of 1440 fragments"),
    ("elements behind a loop", "probe/behind_loop.frag", "sum += last", "sum += last + 1u",
     "480 have a wrong sum"),
    ("local arrays in a loop", "probe/stored_ahead.frag", "== words[i ^ 1u]", "> 128u", "0 of 128"),
    ("textures of one buffer", "probe/texture_format.frag", "texelFetch(texels, 1)", "texelFetch(texels, 0)",
     "0 of 480 pixels"),
    ("interlock", "probe/locked_count.frag", "+ 1u", "+ 2u", "plain increments"),
    ("framebuffer fetch", "probe/fetch.frag", "out_seen.y + 1u", "1u", "0 of 480"),
    ("framebuffer fetch", "probe/fetch.frag", "out_seen.x + quad", "out_seen.x - quad", "0 of 480"),
    ("framebuffer fetch", "probe/show_fetched.frag", "out_seen.xy", "uvec2(32, 0)", "0 of 480"),
    ("uniform blocks after a dispatch", "probe/after_dispatch.frag", "float(height)", "float(height + 1u)", "0 of 480"),
    ("points after a dispatch", "common/list_tiles.comp", "if (tile_has_fragments(tile)) list(tile)", "",
     "pixels right"),
    ("nearest 33 in registers", "common/nearest.glsl", "fragment.x < from", "fragment.x >= from", "pixels right"),
    ("triangles", "scene/triangle.vert", "gl_Position = in_corner;", "gl_Position = in_corner + vec4(0.004, 0, 0, 0);",
     "impossible"),
    ("triangles", "scene/triangle.vert", "gl_Position = in_corner;",
     "gl_Position = in_corner * vec4(1, 1, 0.999, 1);", "with a depth out of bounds"),
])
def test_a_fault_is_seen(device, plant, name, path, right, wrong, said):
    plant(path, right, wrong)
    trial = BY_NAME[name]
    if trial.feature and trial.feature not in device.offered:
        pytest.skip(f"this device lacks {trial.feature}")
    passed, detail = trial.outcome(device)
    assert not passed
    assert said in detail


def test_elements_are_in_their_place_where_they_are_stored_before_the_comparison(device, plant):
    """Shaders of methods store so; what the trial itself does is wrong on llvmpipe 22.3.6."""
    compare, store = "bool more = i + 2u < count;", "held[i] = min(a, b);\n        held[i + 1u] = max(a, b);"
    plant("probe/stored_ahead.frag", f"{compare}\n        {store}", f"{store}\n        {compare}")
    passed, detail = outcome(device, "local arrays in a loop")
    assert passed
    assert "128 of 128" in detail


@pytest.fixture
def untried(device):
    """The device, of which it is not known whether it needs a flush after dispatches, before and after the test."""
    device.__dict__.pop("flushes_dispatches", None)
    yield device
    device.__dict__.pop("flushes_dispatches", None)


@pytest.mark.parametrize("trial", [trials.uniform_blocks, trials.listed_points])
def test_a_driver_that_needs_a_flush_gets_one(untried, monkeypatch, trial):
    """Draws between a dispatch and a flush are spoilt here, as zink spoils them."""
    dispatch, draw, flush, finish = PassRunner._dispatch, PassRunner._within, untried.gl.glFlush, untried.finish
    spoilt = []
    monkeypatch.setattr(PassRunner, "_dispatch", lambda self, at: (spoilt.append(True), dispatch(self, at)))
    monkeypatch.setattr(PassRunner, "_within", lambda self, *what: None if spoilt else draw(self, *what))
    monkeypatch.setattr(untried.gl, "glFlush", lambda: (spoilt.clear(), flush()))
    monkeypatch.setattr(untried, "finish", lambda: (spoilt.clear(), finish()))
    passed, detail = trial(untried)
    assert passed and untried.flushes_dispatches
    assert "behind a flush" in detail


@pytest.mark.parametrize(("wanted", "tried"), [(None, True), (frozenset({TILE_POINTS}), True), (frozenset(), False)])
def test_points_after_a_dispatch_are_tried_where_they_are_wanted(untried, monkeypatch, wanted, tried):
    """Draws of other kinds after a dispatch are tried in any case."""
    drawn = []
    for name in ("uniform_blocks", "listed_points"):
        monkeypatch.setattr(trials, name, lambda device, name=name: (drawn.append(name), (True, ""))[1])
    monkeypatch.setattr(untried, "wanted", wanted)
    assert not untried.flushes_dispatches
    assert drawn == ["uniform_blocks", *["listed_points"] * tried]


def test_a_frame_knows_whether_it_flushes_before_it_draws(untried, monkeypatch):
    """`adaptive` compiles passes while it draws, when a trial would spoil the state of the frame."""
    with shown(untried, generate(SceneConfig(size=(16, 16), depth_complexity=3))) as on:
        frame = Frame(untried, Fitted(catalog()["adaptive"].variant({}), on.stats), on.scene_buffer, on.canvas)
        monkeypatch.delattr(type(untried), "flushes_dispatches")
        untried.__dict__.pop("flushes_dispatches", None)
        frame.draw_fitting()
        frame.release()


def test_a_dispatch_of_any_method_is_flushed_where_the_driver_needs_it(untried, monkeypatch):
    """Not only before points: on zink any draw after a dispatch may read wrong uniform blocks."""
    untried.flushes_dispatches = True
    flushed = []
    monkeypatch.setattr(untried.gl, "glFlush", lambda: flushed.append(True))
    with shown(untried, generate(SceneConfig(size=(16, 16), depth_complexity=3))) as on:
        on.render(catalog()["ab-sb"].variant({"resolve": "compute"}))
    assert flushed


def test_a_feature_that_fails_its_trial_is_missing_with_the_trials_name(monkeypatch):
    wrong = Trial("points after a dispatch", lambda device: (False, "3 of 9 pixels right"), TILE_POINTS)
    monkeypatch.setattr(trials, "TRIALS", (wrong, Trial("other", lambda device: (False, ""), "not offered")))
    found = failed(SimpleNamespace(offered=frozenset({TILE_POINTS}), wants=lambda feature: True))
    assert found == {TILE_POINTS: "the trial 'points after a dispatch' (3 of 9 pixels right)"}
    cell = Cell("test", "ab-array", "ab-array", catalog()["ab-array"].complete({"touched": "tiles"}),
                SceneConfig(size=(8, 8), depth_complexity=3), Measure(), {})
    limits = Limits(features=frozenset(), max_block_bytes=2**27, max_texture_size=4096, failed_trials=found)
    assert judge(cell, catalog(), expected_stats(cell.scene), limits) == (
        "unsupported", "needs points_16, which fails the trial 'points after a dispatch' (3 of 9 pixels right)")


@pytest.mark.parametrize(("params", "refused"), [
    ({"k": 33}, True), ({"k": 33, "sort": "register"}, True), ({"k": 33, "sort": "hybrid"}, False),
    ({"k": 32}, False), ({"k": 34}, False)])
def test_where_33_in_registers_fail_their_trial_no_other_k_and_no_other_sort_is_refused(params, refused):
    found = "the trial 'nearest 33 in registers' (0 of 54 pixels right)"
    limits = Limits(features=frozenset(), max_block_bytes=2**27, max_texture_size=4096,
                    failed_trials={NEAREST_33: found})
    cell = Cell("test", "kb-ab-ll", "kb-ab-ll", catalog()["kb-ab-ll"].complete(params),
                SceneConfig(size=(8, 8), depth_complexity=3), Measure(), {})
    said = ("unsupported", f"needs nearest_33, which fails {found}") if refused else None
    assert judge(cell, catalog(), expected_stats(cell.scene), limits) == said


def test_a_feature_that_nothing_needs_is_neither_tried_nor_used(device, monkeypatch):
    tried = []
    every = [Trial(each.name, lambda device, name=each.name: (bool(tried.append(name)), ""), each.feature)
             for each in TRIALS]
    monkeypatch.setattr(trials, "TRIALS", every)
    fresh = replace(device, wanted=frozenset({TILE_POINTS, "not offered"}))
    assert fresh.limits.failed_trials.keys() == {TILE_POINTS} and tried == ["points after a dispatch"]
    assert fresh.limits.features == frozenset() and {TILE_POINTS, NEAREST_33} <= fresh.offered


FEATURES = frozenset({trial.feature for trial in TRIALS if trial.feature} | {"samples_4", "samples_8", "msaa_8"})


@pytest.mark.parametrize("config", ["smoke", "msaa", "adaptive"])
def test_no_cell_is_judged_otherwise_for_what_was_not_tried(config):
    """Whichever features the device has."""
    experiment, = load(config, catalog(), "smoke", ())
    cells = expand(experiment, catalog())
    for lacking in (frozenset(), FEATURES, *(frozenset({feature}) for feature in sorted(FEATURES))):
        for cell in cells:
            said = []
            for tried in (FEATURES, features_for([cell], catalog())):
                limits = Limits(features=(FEATURES - lacking) & tried, max_block_bytes=2**27, max_texture_size=4096,
                                failed_trials=dict.fromkeys(lacking & tried, "the trial"))
                stats = expected_stats(cell.scene)
                fitted = Fitted(catalog()[cell.method].variant(cell.params), stats, limits.features)
                said.append((judge(cell, catalog(), stats, limits), fitted.memory_bytes()))
            assert said[0] == said[1], cell.label


def test_every_trial_says_what_a_failure_costs():
    assert {trial.name for trial in TRIALS if trial.costs is None} == {
        "atomic operations", "blending", "queries", "full registers", "uniform blocks after a dispatch"}
