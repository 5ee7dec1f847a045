"""Every option by which fragments can meet in another way is a configuration of a campaign."""

from dataclasses import replace

import pytest

from mfr_bench.effects import EFFECTS, Settings
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Above, Param
from mfr_bench.race.campaign import run
from mfr_bench.race.check import How
from mfr_bench.race.options import SAME_ACCESSES, acting, base, concurrent_key, configurations, others
from mfr_bench.race.promise import Kind
from mfr_bench.race.scenes import row_of

SCENE = row_of((3, 2))
WHOLE = (0, 1, 2, 3, 4, 8, 16, 32, 100)
PARTS = (0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99)
METHODS = pytest.mark.parametrize("method", catalog().values(), ids=lambda m: m.id)


def probes(param: Param) -> list:
    """Values all over the range of a parameter."""
    if param.choices or param.of:
        return list(param.choices or param.of)
    low, high = param.low, param.high
    if param.real:
        return [low + (high - low) * part for part in PARTS]
    return sorted({int(v) for v in (low, high, *WHOLE) if low <= v <= high})


def changed(method, param: Param) -> list:
    """The values of a parameter with which what runs concurrently is other code than at the default."""
    start = acting(method, param)
    if isinstance(param.acts, Above):
        start |= {param.acts.name: start[param.acts.name] + 1}
    alone = concurrent_key(method.variant(start), SCENE)
    return [v for v in probes(param) if concurrent_key(method.variant(start | {param.name: v}), SCENE) != alone]


@METHODS
def test_an_option_that_changes_what_runs_concurrently_is_in_the_campaign(method):
    missing = {p.name: changed(method, p) for p in method.params if not others(p) and p.name not in SAME_ACCESSES}
    assert not any(missing.values()), f"add values to NUMBERS, or a reason to SAME_ACCESSES: {missing}"


def test_an_option_that_only_another_lets_act_is_in_the_campaign():
    run_with = [v.params for v in configurations(catalog()["lin-pre"], SCENE, together=1)]
    assert any(p["insert"] == "max64" and p["atomic64"] == "emulated" for p in run_with)
    assert any(p["early_culling"] == "on" and p["culling_opacity"] == 0.5 for p in run_with)


@METHODS
def test_no_effect_changes_what_runs_concurrently(method):
    """Effects read the sorted fragments of a pixel in passes that write no memory, so that campaigns need only one."""
    variant = method.variant(base(method))
    keys = {concurrent_key(variant, replace(SCENE, effect=Settings(name))) for name in EFFECTS}
    assert keys == {concurrent_key(variant, SCENE)}


def test_what_a_setting_loses_and_counts_breaks_no_promise():
    """Two slots for three fragments: the last to come is lost, as `room` says, and counted."""
    found = run(catalog()["ab-array"].variant({"room": 2}), (3, 2), How(schedules=300), scenes=1)
    assert found.checker.promised.kind is Kind.IN_ORDER and found.checker.promised.counted
    assert found.failure is None
