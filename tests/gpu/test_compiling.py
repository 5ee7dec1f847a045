"""Passes over the screen blend where that spares a driver a compilation; images are the same with and without."""

from __future__ import annotations

import pytest

from mfr_bench.config.model import Scene
from mfr_bench.gpu import rawgl
from mfr_bench.gpu.context import Device
from mfr_bench.gpu.pass_runner import PassRunner

from ..contract.cases import Drawn, catalog

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
    (False, False, 20, False), (True, False, 5, True), (True, True, 5, False), (True, True, 20, True)])
def test_where_passes_over_the_screen_blend(device, monkeypatch, twice, timed, layers, blends):
    """Where times count, only those that sort many fragments in registers: the compiler takes longest for them."""
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
