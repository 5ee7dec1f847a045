"""Full-screen passes blend so that a driver compiles them once, and their images are the same with and without."""

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
    return Drawn(device, catalog()[method].variant({}), SCENE).image.tobytes()


@pytest.mark.parametrize("method", METHODS)
def test_images_are_the_same_to_the_bit(device, monkeypatch, method):
    assert image(device, monkeypatch, method, True) == image(device, monkeypatch, method, False)


@pytest.mark.parametrize("twice", [True, False])
def test_a_pass_over_the_screen_blends_only_where_that_saves_compiling(device, monkeypatch, twice):
    switched, begin = {}, PassRunner._begin

    def note(runner, framebuffer, iteration):
        begin(runner, framebuffer, iteration)
        calls = [call for call in runner._state_calls if call.args == (rawgl.BLEND,)]
        switched.setdefault(runner.step.kind, set()).update(call.func == device.gl.glEnable for call in calls)

    monkeypatch.setattr(PassRunner, "_begin", note)
    image(device, monkeypatch, "ab-ll", twice)
    assert switched == {"fullscreen": {twice}, "geometry": {False}}
