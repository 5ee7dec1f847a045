"""Devices and timers: names of folders, programs compiled once, times by pass."""

import re

import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.environment import processor
from mfr_bench.gpu.device import slug
from mfr_bench.gpu.frame import Frame
from mfr_bench.gpu.scene_buffer import SceneBuffer
from mfr_bench.gpu.targets import Canvas
from mfr_bench.gpu.timers import GpuTimer, WallTimer
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.oracle.composite import stats_of
from mfr_bench.scene import generate


@pytest.mark.parametrize(("renderer", "name"), [
    ("llvmpipe (LLVM 15.0.6, 256 bits)", "llvmpipe"),
    ("NVIDIA H200/PCIe/SSE2", "nvidia-h200"),
    ("NVIDIA GeForce RTX 4090/PCIe/SSE2", "nvidia-geforce-rtx-4090"),
    ("AMD Radeon RX 7900 XT (radeonsi, navi31)", "amd-radeon-rx-7900-xt"),
    ("Mesa Intel(R) Arc(tm) A770 Graphics (DG2)", "mesa-intel-arc-a770-graphics"),
    ("", "unknown"),
    ("../..", "unknown"),
])
def test_a_folder_is_named_by_the_renderer(renderer, name):
    assert slug(renderer) == name


def test_a_device_says_what_it_is(device):
    assert set(device.info) == {"renderer", "vendor", "version", "slug", "kind"}
    assert device.kind in ("gpu", "cpu")
    assert (processor() in device.info["renderer"]) == (device.kind == "cpu")  # whose cells another processor's are not
    assert device.info["slug"].endswith(slug(processor())) == (device.kind == "cpu")
    assert device.limits.max_block_bytes >= 2**24  # what GL 4.3 guarantees
    assert device.limits.features == device.features
    assert not device.features & device.missing_features
    device.check("nothing")


@pytest.fixture
def frame(device):
    scene = generate(SceneConfig(size=(32, 24), depth_complexity=4))
    quads, canvas = SceneBuffer(device, scene), Canvas(device, (32, 24))
    made = Frame(device, Fitted(catalog()["ab-array"].variant({}), stats_of(scene)), quads, canvas)
    yield made
    for thing in (made, canvas, quads):
        thing.release()


def test_programs_are_compiled_once(device, frame):
    compiled = len(device.programs)
    again = Frame(device, Fitted(frame.variant, frame.stats), frame.scene_buffer, frame.canvas)
    again.release()
    assert len(device.programs) == compiled


@pytest.mark.parametrize("kind", [WallTimer, GpuTimer])
def test_timers_name_every_pass_in_order(device, frame, kind):
    timer = kind(device)
    assert timer.frame_ms(frame.draw) > 0
    passes = timer.passes_ms(frame.draw)
    assert tuple(passes) == frame.variant.pass_names
    assert all(time_ms >= 0 for time_ms in passes.values())
    assert re.fullmatch("wall|gpu", timer.name)
    assert timer.resolution_ms is None or 0 < timer.resolution_ms < 1
    assert timer.frame_ms(frame.draw, repeats=3) > 0
