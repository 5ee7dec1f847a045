"""The vocabulary of declarations: formulas, capacities that grow, parameters, and what a variant keeps of a method."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mfr_bench.methods import catalog
from mfr_bench.methods.spec import (
    Buffer,
    Counted,
    Fitted,
    Grown,
    Loop,
    Method,
    Param,
    Pass,
    SceneStats,
    Target,
    doubled,
    evaluate,
    when,
)

SIZES = SceneStats(W=8, H=6, n=4, F=96, primitives=4, histogram=(16, 16, 8, 0, 16 // 2))


def declared(**more):
    return Method(**{"id": "test", "name": "test", "family": "test", "source": "test", "summary": "", "words": "0",
                     "guarantee": "exact all", "ties": "", "steps": ()} | more)


# --- formulas ------------------------------------------------------------------------------------


@pytest.mark.parametrize(("formula", "value"), [
    ("0", 0), ("2*n*P", 384), ("W + H", 14), ("F / P", 2), ("f", 2), ("3*f + 1", 7), ("ceil(P / 32)", 2),
    ("floor(n / 3)", 1), ("log2(n)", 2), ("max(k, n)", 5), ("min(k, n)", 4), ("doubled(10, F)", 160), ("k", 5),
    ("bounded(1)", 32), ("bounded(k)", 64), ("f_k", 64 / 48),
])
def test_formulas_know_the_frame_and_the_parameters(formula, value):
    assert evaluate(formula, SIZES, {"k": 5}) == pytest.approx(value)


@pytest.mark.parametrize("formula", ["unknown", "open('x')", "__import__('os')", "().__class__.__base__.unknown"])
def test_a_formula_that_names_anything_else_fails(formula):
    with pytest.raises((NameError, AttributeError)):
        evaluate(formula, SIZES, {})


def test_bounded_is_what_k_per_pixel_leave():
    assert [SIZES.bounded(k) for k in (1, 2, 3, 4, 99)] == [32, 48, 56, 64, 64]
    assert SceneStats(W=1, H=1, n=1, F=0, primitives=0, histogram=(1,)).bounded(4) == 0


@given(st.integers(1, 10**6), st.integers(0, 10**9))
def test_doubling_stops_at_the_first_capacity_that_holds(start, needed):
    capacity = doubled(start, needed)
    steps = (capacity // start).bit_length() - 1
    assert capacity == start * 2**steps
    assert capacity >= needed
    assert steps == 0 or capacity // 2 < needed


# --- parameters ----------------------------------------------------------------------------------

COUNT = Param("count", 8, "", low=2, high=64)
SHARE = Param("share", 0.5, "", low=0, high=1, real=True)
SWITCH = Param("culling", "on", "", choices=("on", "off"))
SORT = Param("sort", "shell", "", choices=("insertion", "shell"), needs={"insertion": "patience"})
TOUCHED = Param("touched", "off", "", choices=("off", "bounds"))


@pytest.mark.parametrize(("param", "given_", "value"), [
    (COUNT, 2, 2), (COUNT, 64, 64), (SHARE, 0.25, 0.25), (SWITCH, True, "on"), (SWITCH, False, "off"),
    (SWITCH, "off", "off"), (TOUCHED, False, "off"), (SORT, "insertion", "insertion"),
])
def test_values_are_made_canonical(param, given_, value):
    assert param.parse(given_) == value
    assert type(param.parse(given_)) is type(value)


@pytest.mark.parametrize(("param", "refused", "said"), [
    (COUNT, 1, "1 is not allowed; allowed: a whole number from 2 to 64"), (COUNT, 65, "65"), (COUNT, 8.0, "8.0"),
    (COUNT, "8", "'8'"), (COUNT, True, "True"), (COUNT, None, "no value is given; allowed"), (COUNT, [8], r"\[8\]"),
    (SHARE, 0, "0 is not allowed; allowed: a number between 0 and 1"), (SHARE, 1, "1"), (SHARE, float("nan"), "nan"),
    (SHARE, float("inf"), "inf"), (SHARE, True, "True"), (SHARE, "0.5", "'0.5'"),
    (TOUCHED, True, "True"),
    (SORT, "shel", r"'shel' is not allowed; allowed: insertion \| shell; nearest: 'shell'"), (SORT, True, "True"),
    (SWITCH, "yes", "'yes' is not allowed; allowed: on | off"), (SWITCH, 1, "1"),
])
def test_other_values_are_refused_with_what_is_allowed(param, refused, said):
    with pytest.raises(ValueError, match=said):
        param.parse(refused)


def test_a_variant_has_every_parameter():
    method = declared(params=(COUNT, SWITCH), fixed=(SORT.at("insertion"),))
    variant = method.variant({"count": 4, "unrelated": 3})
    assert variant.params == {"count": 4, "culling": "on"}
    assert variant.scope == {"count": 4, "culling": "on", "sort": "insertion"}
    assert hash(variant) == hash(method.variant({"culling": True, "count": 4}))
    assert variant == method.variant({"culling": "on", "count": 4})


def test_parameters_need_features():
    method = declared(params=(SORT,), needs=("light",))
    assert method.variant({"sort": "shell"}).needs == ("light",)
    assert method.variant({"sort": "insertion"}).needs == ("light", "patience")


# --- what a variant keeps ------------------------------------------------------------------------


def test_conditions_choose_buffers_targets_and_passes():
    culled, open_ = when("culling", "on"), when("culling", "off")
    method = declared(
        params=(SWITCH,),
        buffers=(Buffer("always", "P"), Buffer("bound", "P", when=culled)),
        targets=(Target("depth", "depth32f", when=open_),),
        steps=(Pass("first", "clear", when=open_),
               Loop((Pass("peel", "clear"), Pass("cull", "clear", when=culled)), "n")))
    on, off = method.variant({}), method.variant({"culling": "off"})
    assert [b.name for b in on.buffers] == ["always", "bound"]
    assert [b.name for b in off.buffers] == ["always"]
    assert [t.name for t in on.targets] == []
    assert [t.name for t in off.targets] == ["depth"]
    assert (on.pass_names, off.pass_names) == (("peel", "cull"), ("first", "peel"))
    assert method.pass_names == ("first", "peel", "cull")
    assert [len(s.passes) for s in on.steps if isinstance(s, Loop)] == [2]


def test_passes_of_one_name_are_named_once():
    method = declared(steps=(Pass("scan", "clear"), Pass("sum", "clear"), Pass("scan", "clear")))
    assert method.pass_names == ("scan", "sum")


@pytest.mark.parametrize(("guarantee", "layers", "kept"), [("exact all", None, 96), ("exact k nearest", 2, 48)])
def test_a_method_keeps_what_it_promises(guarantee, layers, kept):
    variant = declared(guarantee=guarantee, params=(Param("k", 2, ""),)).variant({})
    assert variant.layers == layers
    assert Fitted(variant, SIZES).kept() == kept


# --- memory --------------------------------------------------------------------------------------


def test_memory_is_counted_by_resource():
    variant = declared(buffers=(Buffer("counter", "P"), Buffer("nodes", "2*n*P", type="uvec2", copies=2)),
                       targets=(Target("colour", "rgba32f", copies=2), Target("depth", "depth32f"))).variant({})
    assert Fitted(variant, SIZES).memory_bytes() == {
        "counter": 4 * 48, "nodes": 2 * 4 * 2 * 4 * 48, "colour": 2 * 16 * 48, "depth": 4 * 48}


def test_the_papers_formula_is_words_per_pixel():
    assert Fitted(declared(words="2*k + 2", params=(Param("k", 3, ""),)).variant({}), SIZES).model_bytes() == 4 * 48 * 8
    assert Fitted(declared(words="3*f + 1").variant({}), SIZES).model_bytes() == 4 * 48 * 7


def test_a_growing_buffer_doubles_from_its_start_until_the_frame_fits():
    variant = declared(capacity=Grown("P // 4", "allocated"), buffers=(Buffer("nodes", "capacity"),)).variant({})
    assert Fitted(variant, SIZES).start_capacity() == 12
    assert Fitted(variant, SIZES).capacity() == 96
    assert Fitted(variant, SIZES).memory_bytes() == {"nodes": 4 * 96}
    few = SceneStats(W=8, H=6, n=1, F=5, primitives=1)
    assert Fitted(variant, few).capacity() == 12


def test_a_counted_buffer_holds_exactly_the_frame():
    variant = declared(capacity=Counted(), buffers=(Buffer("nodes", "2*capacity", type="uvec2"),)).variant({})
    assert Fitted(variant, SIZES).start_capacity() == 0
    assert Fitted(variant, SIZES).memory_bytes() == {"nodes": 4 * 2 * 96}


def test_an_empty_buffer_still_holds_one_element():
    empty = SceneStats(W=8, H=6, n=1, F=0, primitives=0)
    variant = declared(capacity=Counted(), buffers=(Buffer("nodes", "2*capacity", type="uvec2"),)).variant({})
    assert Fitted(variant, empty).memory_bytes() == {"nodes": 8}


@pytest.mark.parametrize(("per_pass", "occupancy"), [(4, 32), (0, 32)])
def test_a_parameter_whose_effect_depends_on_another_is_settled_behind_it(per_pass, occupancy):
    """Occupancy culling, which needs a single pass, is allowed at k = 4, where a `per_pass` of 4 has no effect."""
    chosen = catalog()["kb"].complete({"k": 4, "per_pass": per_pass, "occupancy": occupancy})
    assert (chosen["per_pass"], chosen["occupancy"]) == (0, occupancy)


@pytest.mark.parametrize("method", catalog().values(), ids=lambda m: m.id)
def test_parameters_stand_behind_those_that_their_effect_depends_on(method):
    names = [p.name for p in method.params]
    for at, param in enumerate(method.params):
        condition = param.acts
        while condition:
            others = {condition.name, getattr(condition, "other", condition.name)} - {param.name}
            late = [n for n in others if method.param(n) and method.param(n).acts and names.index(n) > at]
            assert not late, f"{param.name} is settled before {late}"
            condition = getattr(condition, "also", None)


@pytest.mark.parametrize(("params", "error"), [
    ({}, None), ({"stop_opacity": 0.75}, 0.25), ({"accumulate": "unorm8"}, None),
    ({"stop_opacity": 0.75, "accumulate": "unorm8"}, None)])
def test_the_error_that_parameters_bring_is_known_if_each_of_them_says_it(params, error):
    assert catalog()["ab-array"].variant(params).weakened_error == error


def test_of_several_weaknesses_the_largest_error_holds():
    weak = catalog()["lin-pre"].variant({"early_culling": "on", "culling_opacity": 0.5, "stop_opacity": 0.75})
    assert weak.weakened_error == 0.5
