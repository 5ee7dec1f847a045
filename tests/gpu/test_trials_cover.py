"""Everything that methods ask of a driver has a trial: atomic operations, ways of blending, kinds of queries."""

import re
from functools import cache
from pathlib import Path

import mfr_bench
from mfr_bench import glsl
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.contract.preprocess import active
from mfr_bench.gpu import trials
from mfr_bench.gpu.trials import BLENDED
from mfr_bench.methods.spec import IMAGE, Fitted, State
from mfr_bench.plan import expected_stats

from ..contract.cases import every_method, variants

ATOMIC = re.compile(r"\b((?:image)?[aA]tomic[A-Z]\w*)\s*\(\s*(\w+)")
SIZES = expected_stats(SceneConfig(size=(64, 48), depth_complexity=40, pixel_density=0.5))


@cache
def atomics_in(text):
    """The atomic operations that a shader calls: function, type of what it changes; macros stand for their calls."""
    code = active(text)
    found = set()
    for function, name in ATOMIC.findall(code):
        macro = re.search(rf"#define (\w+)\({name}\)", code)
        names = re.findall(rf"(?<!#define ){macro[1]}\(\s*(\w+)", code) if macro else [name]
        found |= {(function, declared[1]) for changed in names
                  if (declared := re.search(rf"(\w+) {changed}(?:\[\])?;", code))}
        assert not names or found, f"{function} of {name}"
    return found


def atomics_of(variant):
    """The atomic operations of a variant's passes, each with whether a compute shader calls it."""
    fitted = Fitted(variant, SIZES)
    return {(step.kind == "compute", *use) for step in variant.passes if step.kind != "clear"
            for use in atomics_in(glsl.source(fitted, step).text)}


def test_every_atomic_operation_of_a_method_has_a_trial():
    used = {use for method in every_method() for variant in variants(method) for use in atomics_of(variant)}
    tried = {use for trials_of in (trials.OPERATIONS, trials.OPERATIONS64) for method in trials_of.values()
             for use in atomics_of(method.variant({}))}
    assert {function for _, function, _ in used} >= {"atomicAdd", "atomicCounterIncrement", "atomicExchange"}
    assert used - tried == set()


def blends_of(variant):
    """Formats of the targets of each blended pass, and how it blends; the image is rgba32f."""
    formats = {target.name: target.format for target in variant.targets if target.attaches == "colour"}
    formats[IMAGE] = "rgba32f"
    for step in variant.passes:
        drawn = [formats[name] for ref in step.into if (name := ref.partition(".")[0]) in formats]
        if step.state.blends:
            yield tuple(drawn), State(blends=step.state.blends)
        elif step.state.blend:
            state = State(blend=step.state.blend, blend_alpha=step.state.blend_alpha)
            yield from (((format,), state) for format in drawn)


def test_every_way_that_a_method_blends_has_a_trial():
    used = {use for method in every_method() for variant in variants(method) for use in blends_of(variant)}
    assert used == set(BLENDED)


def test_every_kind_of_query_has_a_trial():
    asked = re.compile(r"gl(?:BeginQuery|QueryCounter)\([^)]*?rawgl\.(\w+)")
    folder = Path(mfr_bench.__file__).parent
    used = {kind for path in folder.rglob("*.py") for kind in asked.findall(path.read_text())
            if path.name != "trials.py"}
    assert "SAMPLES_PASSED" in used
    assert used <= set(asked.findall(Path(trials.__file__).read_text()))
