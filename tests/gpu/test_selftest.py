"""The findings of `doctor`: the tests pass here, fail on planted faults, and the timer is chosen by its agreement."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mfr_bench import glsl
from mfr_bench.gpu import selftest
from mfr_bench.gpu.selftest import calibrate, self_tests
from mfr_bench.gpu.trials import TRIALS


def by_name(device):
    return {f.name: f for f in self_tests(device)}


SELF_TESTS = {"atomics", "side effects under a full draw", "barriers", "spin lock", "slanted depths",
              "stencil routing"}


def test_this_device_does_what_the_methods_rely_on(device):
    findings = by_name(device)
    assert set(findings) == SELF_TESTS | {trial.name for trial in TRIALS}
    needs = {trial.name: trial.feature for trial in TRIALS if trial.feature} | {"stencil routing": "samples_4"}
    for finding in findings.values():
        assert (finding.passed is None) == (finding.name in needs and needs[finding.name] not in device.offered)
        assert finding.passed is not False or finding.costs, finding


def test_the_page_of_drivers_has_each_trial_and_no_other():
    page = (Path(__file__).parents[2] / "docs" / "drivers.md").read_text()
    rows = page.partition("| trial |")[2].partition("\n\n")[0].splitlines()[2:]
    there = SELF_TESTS | {re.sub(r" of \d samples", "", trial.name) for trial in TRIALS}
    told = [row.split("|")[1].partition("(")[0].strip() for row in rows]
    named = {name for cell in told for name in cell.removesuffix(" of 2, 4 and 8 samples").split(", ")}
    assert named == there


@pytest.mark.parametrize(("path", "right", "wrong", "seen"), [
    ("probe/total.frag", "atomicAdd(total[0], 1u)", "atomicAdd(total[0], 2u)", "atomics"),
    ("probe/show_count.frag", "float(counter[pixel_index()])", "float(counter[0]) + 1.0", "barriers"),
    ("probe/locked_count.frag", "+ 1u", "+ 2u", "spin lock"),
    ("probe/total.frag", "void main", "void mian", "atomics"),
    ("probe/rasterized.frag", "void main() {", "void main() { gl_FragDepth = gl_FragCoord.z + 6e-8;", "slanted depths"),
])
def test_a_device_that_does_wrong_is_found_out(device, monkeypatch, path, right, wrong, seen):
    real = glsl.read
    assert right in real(path)
    before = {name for name, f in by_name(device).items() if f.passed is False}
    monkeypatch.setattr(glsl.includes, "read", lambda p: real(p).replace(right, wrong) if p == path else real(p))
    findings = by_name(device)
    also = {"interlock"} if seen == "spin lock" and "fragment_shader_interlock" in device.offered else set()
    assert {name for name, f in findings.items() if f.passed is False} - before == {seen} | also


def test_a_device_that_draws_nothing_holds_no_depth_that_shaders_see(device, monkeypatch):
    """The self-test fails; it does not end in an error."""
    real = selftest.capture

    def nothing(*given):
        found = real(*given)
        return replace(found, counts=np.zeros_like(found.counts), depth=found.depth[:0])
    monkeypatch.setattr(selftest, "capture", nothing)
    passed, told = selftest._slanted(device)
    assert not passed and told.startswith("0 of ")


@pytest.mark.parametrize(("wall_ms", "gpu_ms", "timer", "reason"), [
    ([2.0, 4.0, 8.0], [2.1, 4.1, 7.9], "gpu", "GPU timers agree with the wall clock within 15 %"),
    ([2.0, 4.0, 8.0], [2.4, 4.1, 8.0], "wall", "GPU timers show 1.2 of the wall time"),
    ([2.0, 4.0, 8.0], [0.03, 0.06, 0.11], "wall", "GPU timers show 0.014 of the wall time"),
    ([0.5, 1.0, 4.0], [0.1, 0.2, 4.0], "gpu", "agree"),  # short work is no evidence against a timer
    ([0.5, 1.0, 1.9], [0.5, 1.0, 1.9], "wall", "nothing to compare"),
    ([], [], "wall", "nothing to compare"),
])
def test_gpu_timers_count_where_they_agree_with_the_wall_clock(wall_ms, gpu_ms, timer, reason):
    found = selftest.Calibration(*selftest._verdict("gpu", wall_ms, gpu_ms))
    assert found.timer == timer
    assert reason in found.reason
    assert (found.wall_ms, found.gpu_ms) == (tuple(wall_ms), tuple(gpu_ms))


def test_a_software_device_has_one_timer_however_its_gpu_timers_look():
    """A cell's key has the timer: another one by load would have every cell measured again."""
    assert {selftest._verdict("cpu", [2.0, 4.0], gpu_ms)[0] for gpu_ms in ([2.0, 4.0], [0.1, 0.2])} == {"wall"}


def test_calibration_measures_work_that_grows(device):
    found = calibrate(device)
    assert len(found.wall_ms) == len(found.gpu_ms) >= selftest.COMPARED
    assert found.wall_ms[-1] >= selftest.LONG_ENOUGH_MS
    assert found.timer in ("gpu", "wall")
