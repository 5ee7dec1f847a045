"""Plans of frames: made and printed without GL, with barriers where passes meet in memory and reasons for the rest."""

import subprocess
import sys
from dataclasses import replace

import pytest

from mfr_bench.config import Scene
from mfr_bench.gpu.plan import Barriers, PassPlan, as_text, frame_plan
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted, FrameState
from mfr_bench.plan import expected_stats

STATS = expected_stats(Scene(size=(64, 48), depth_complexity=12, pixel_density=0.5))


def fitted(method, **params):
    return Fitted(catalog()[method].variant(params), STATS)


def reasons(plan):
    return {(step.name, reason) for step, reason in plan.left_out}


def test_a_plan_is_printed_without_gl():
    code = ("import sys; sys.argv[1:] = ['shader', 'ab-sb', '--plan']\nfrom mfr_bench.cli import main\n"
            "try:\n    main()\nexcept SystemExit:\n    pass\n"
            "assert not {'moderngl', 'glcontext'} & {name.partition('.')[0] for name in sys.modules}")
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    lines = said.splitlines()
    assert lines[:2] == ["barrier", "clear: fullscreen common/clear.frag"]
    assert "  buffer 0: counter (write)" in lines
    assert lines[-2:] == ["left out: resolve (probe)", "left out: resolve (scene)"]  # a probe, and another sort


def test_a_barrier_comes_before_what_an_earlier_pass_wrote():
    variant = fitted("ab-array", sort="insertion").variant
    clear, store, resolve = (PassPlan.of(variant, p) for p in variant.passes if not p.probes)
    barriers = Barriers(())
    assert [barriers.due(step) for step in (clear, store, resolve)] == [False, True, True]
    assert not barriers.due(resolve)  # it only reads what the one before read


def test_what_the_frame_before_accessed_is_waited_for_where_it_is_written():
    variant = fitted("ab-array", sort="insertion").variant
    clear, _, resolve = (PassPlan.of(variant, p) for p in variant.passes if not p.probes)
    assert Barriers(("counter",)).due(clear)
    assert not Barriers(("counter", "nodes")).due(resolve)


@pytest.mark.parametrize(("state", "runs", "reason"), [
    (FrameState(), "count", None),
    (FrameState(static=True), "rewind", ("count", "static frame")),
    (FrameState(probing=True), "count", None),
])
def test_a_static_frame_leaves_out_what_stands(state, runs, reason):
    plan = frame_plan(fitted("ab-sb", reuse_count="on"), state)
    if reason:
        assert reason in reasons(plan)
    else:
        assert (runs, "static frame") not in reasons(plan)
    assert (("resolve", "probe") in reasons(plan)) != state.probing


def test_passes_that_a_scene_has_no_use_for_are_left_out():
    plan = frame_plan(fitted("ab-array", bma="on"), FrameState())
    assert ("resolve", "scene") in reasons(plan)


def test_a_planned_frame_shows_the_path_that_it_takes():
    text = as_text(fitted("adaptive"))
    assert "store: geometry methods/adaptive/store.frag" in text
    assert "left out: blend (plan, 3 times)" in text
    filled = replace(STATS, reach=STATS.primitives * STATS.P, layers=STATS.primitives)
    text = as_text(Fitted(catalog()["adaptive"].variant({}), filled))
    assert "order: compute methods/adaptive/rank.comp" in text
    assert "left out: store (plan, 19 times)" in text
