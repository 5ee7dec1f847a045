"""Passes over the screen blend where that spares a driver a compilation; images are the same with and without."""

from __future__ import annotations

import pytest

from mfr_bench.config.model import Scene
from mfr_bench.gpu import rawgl
from mfr_bench.gpu.context import Device
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.pass_runner import PassRunner
from mfr_bench.gpu.probes import ProbeBench, probe_method
from mfr_bench.gpu.rawgl import FORMATS
from mfr_bench.methods.spec import IMAGE, Fitted, Pass, Target

from ..contract.cases import Drawn, catalog, variants

METHODS = ("ab-ll", "ab-array", "kplus-array", "peel-dual", "wboit", "mboit", "adaptive", "kb-ps")
SCENE = Scene(size=(24, 16), depth_complexity=5, alpha=(0.1, 0.9))


def image(device, monkeypatch, method: str, twice: bool) -> bytes:
    """The image where the driver is said to compile twice, or not."""
    monkeypatch.setattr(Device, "compiles_opaque_twice", twice)
    monkeypatch.setattr(device, "times_frames", False)
    return Drawn(device, catalog()[method].variant({}), SCENE).image.tobytes()


@pytest.mark.parametrize("method", METHODS)
def test_images_are_the_same_to_the_bit(device, monkeypatch, method):
    assert image(device, monkeypatch, method, True) == image(device, monkeypatch, method, False)


@pytest.mark.parametrize(("twice", "timed", "layers", "blends"), [
    (False, False, 20, False), (True, False, 5, True), (True, True, 15, False), (True, True, 16, True)])
def test_where_passes_over_the_screen_blend(device, monkeypatch, twice, timed, layers, blends):
    """Only passes that sort many fragments in registers blend where times count: they take the compiler longest."""
    switched, begin = {}, PassRunner._begin

    def note(runner, framebuffer, iteration):
        begin(runner, framebuffer, iteration)
        calls = [call for call in runner._state_calls if call.args == (rawgl.BLEND,)]
        switched.setdefault(runner.step.name, set()).update(call.func == device.gl.glEnable for call in calls)

    monkeypatch.setattr(PassRunner, "_begin", note)
    monkeypatch.setattr(device, "times_frames", timed)
    monkeypatch.setattr(Device, "compiles_opaque_twice", twice)
    Drawn(device, catalog()["ab-ll"].variant({"sort": "register"}), Scene(size=(24, 16), depth_complexity=layers))
    assert switched == {"clear": {blends and not timed}, "store": {False}, "resolve": {blends}}


PROBED = [method for method, each in catalog().items() if any(step.probes for step in each.variant({}).passes)]


@pytest.mark.parametrize("method", PROBED)
def test_probing_passes_are_compiled_without_a_frame(device, monkeypatch, method):
    """All of those that a frame then runs; that frame counts as if nothing had been drawn between."""
    ran, run = [], PassRunner.run
    monkeypatch.setattr(PassRunner, "run", lambda runner, iteration: (ran.append(runner.step), run(runner, iteration)))
    able = [each for each in variants(catalog()[method]) if set(each.needs) <= device.features]
    if not able:
        pytest.skip(f"this device lacks what all variants of {method} need")
    with ProbeBench(device, SCENE) as bench:
        frames = [Frame(device, Fitted(able[0], bench.stats), bench.scene_buffer, bench.canvas) for _ in range(2)]
        for frame in frames:
            frame.draw_fitting()
        ran.clear()
        frames[0].compile_probes()
        alone = [*ran]
        ran.clear()
        counted = [frame.probe() for frame in frames]
        for frame in frames:
            frame.release()
    assert counted[0] == counted[1]
    assert {step.shader for step in alone} == {step.shader for step in ran if step.probes}


@pytest.mark.parametrize("format", [name for name in FORMATS if name.endswith("f") and "depth" not in name])
def test_values_replace_what_was_in_a_float_target(device, monkeypatch, plant, format):
    """A pass over the screen gives the same value whatever the target held, also where it may blend."""
    plant("probe/work.frag", "out_image = value;", "out_nearest = value;")
    monkeypatch.setattr(Device, "compiles_opaque_twice", True)
    monkeypatch.setattr(device, "times_frames", False)
    with ProbeBench(device, Scene(size=(24, 16), depth_complexity=0)) as bench:
        assert len({_shown(bench, format, before) for before in (0.0, 1.0, 6e4, float("inf"))}) == 1


def _shown(bench: ProbeBench, format: str, before: float) -> bytes:
    """The image of values written to a target of this format that held `before`."""
    work = Pass("work", "fullscreen", "probe/work.frag", into=("nearest",), clears={"nearest": (before,) * 4},
                defines={"ROUNDS": 3})
    show = Pass("show", "fullscreen", "probe/show_depth.frag", reads=("nearest",), into=(IMAGE,))
    frame = bench.frame(probe_method("replaced", work, show, targets=(Target("nearest", format),)))
    frame.draw()
    image = frame.image().tobytes()
    frame.release()
    return image
