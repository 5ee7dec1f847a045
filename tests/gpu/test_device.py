"""Devices and timers: names of folders, programs compiled once, times by pass."""

import json
import re
import subprocess
import sys

import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.environment import processor
from mfr_bench.errors import DeviceError
from mfr_bench.gpu import device as devices
from mfr_bench.gpu.context import slug
from mfr_bench.gpu.egl import EglDevice
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
    ("zink Vulkan 1.4(llvmpipe (LLVM 19.1.7, 256 bits) (MESA_LLVMPIPE))", "zink-llvmpipe"),
    ("zink Vulkan 1.3(NVIDIA GeForce RTX 3080 (NVIDIA_PROPRIETARY))", "zink-nvidia-geforce-rtx-3080"),
    ("D3D12 (NVIDIA GeForce RTX 3060)", "d3d12-nvidia-geforce-rtx-3060"),
    ("virgl (Mesa Intel(R) Graphics (ADL GT2))", "virgl-mesa-intel-graphics"),
    ("virgl", "virgl"),
    ("zink Vulkan 1.3(Virtio-GPU Venus (NVIDIA GeForce RTX 4060) (MESA_VENUS))",
     "zink-virtio-gpu-venus-nvidia-geforce-rtx-4060"),
    ("zink Vulkan 1.2(Microsoft Direct3D12 (Qualcomm(R) Adreno(TM) X1-85 GPU) (MESA_DOZEN))",
     "zink-microsoft-direct3d12-qualcomm-adreno-x1-85-gpu"),
    ("", "unknown"),
    ("../..", "unknown"),
])
def test_a_folder_is_named_by_the_renderer(renderer, name):
    assert slug(renderer) == name


def test_a_device_says_what_it_is(device):
    assert set(device.info) == {"renderer", "vendor", "version", "slug", "kind", "uuid", "pci"}
    assert device.kind in ("gpu", "cpu")
    assert (processor() in device.info["renderer"]) == (device.kind == "cpu")  # whose cells another processor's are not
    assert device.info["slug"].endswith(slug(processor())) == (device.kind == "cpu")
    assert device.limits.max_block_bytes >= 2**24  # what GL 4.3 guarantees
    assert device.limits.features == device.features
    assert not device.features & device.missing_features
    device.check("nothing")


# --- several devices -----------------------------------------------------------------------------

UUIDS = [f"0000000{i}-1111-2222-3333-444444444444" for i in range(4)]


class Opened:
    """The part of a device that the search asks for; `kind` follows from the name as of real ones."""

    def __init__(self, index, renderer):
        self.egl, self.released = EglDevice(index), False
        self.kind = "cpu" if renderer == "llvmpipe" else "gpu"
        self.info = {"renderer": renderer, "kind": self.kind, "uuid": UUIDS[index], "pci": f"0000:0{index}:00.0"}

    def release(self):
        self.released = True


@pytest.fixture
def machine(monkeypatch):
    """Two equal GPUs, one that cannot be opened before them, and the software driver, listed last as EGL does."""
    renderers = [None, "NVIDIA H200", "NVIDIA H200", "llvmpipe"]
    opened = []

    def create(index):
        if renderers[index] is None:
            raise RuntimeError("eglInitialize failed (0x3001)")
        opened.append(Opened(index, renderers[index]))
        return opened[-1]

    monkeypatch.setattr(devices, "egl_devices", lambda: [
        EglDevice(i, UUIDS[i] if i < 2 else None, f"0000:0{i}:00.0" if i else None) for i in range(4)])
    monkeypatch.setattr(devices, "_create", create)
    return opened


@pytest.mark.parametrize(("want", "index"), [
    ("auto", 1), ("gpu", 1), ("cpu", 3), ("2", 2), (UUIDS[2], 2), (UUIDS[1].upper(), 1), ("0000:02:00.0", 2),
    ("pipe", 3), ("GPU-" + UUIDS[2], 2), ("gpu-00000001", 1), ("00000000:02:00.0", 2), ("02:00.0", 2)])
def test_a_device_that_cannot_be_opened_hides_no_other(machine, want, index):
    found = devices.open_device(want)
    assert found.egl.index == index
    assert not found.released
    assert all(device.released for device in machine if device is not found)


@pytest.mark.parametrize("want", ["h200", "NVIDIA"])
def test_a_part_of_several_names_is_told_with_the_devices_that_have_it(machine, want):
    with pytest.raises(DeviceError, match=f"--device {want}: is a part of several names; .*1 NVIDIA H200 0000:01:00.0; "
                       "2 NVIDIA H200 0000:02:00.0;") as told:
        devices.open_device(want)
    assert told.value.exit_status == 2 and all(device.released for device in machine)


@pytest.mark.parametrize(("renderers", "index"), [
    (["NVIDIA H200", "NVIDIA L4", "llvmpipe"], 0), (["llvmpipe", "NVIDIA H200", "llvmpipe"], 1),
    (["AMD Radeon", "NVIDIA H200 NVL", "NVIDIA L4"], 1)])
def test_a_part_of_one_name_alone_finds_its_device(monkeypatch, renderers, index):
    opened = []
    monkeypatch.setattr(devices, "egl_devices", lambda: [EglDevice(i) for i in range(3)])
    monkeypatch.setattr(devices, "_create", lambda i: opened.append(Opened(i, renderers[i])) or opened[-1])
    found = devices.open_device("h200")
    assert found.egl.index == index and not found.released
    assert all(device.released for device in opened if device is not found)


def test_software_drivers_of_one_name_are_one_device(monkeypatch):
    """One name covers several software drivers: with LIBGL_ALWAYS_SOFTWARE EGL may list one behind each GPU."""
    monkeypatch.setattr(devices, "egl_devices", lambda: [EglDevice(i) for i in range(3)])
    monkeypatch.setattr(devices, "_create", lambda i: Opened(i, "llvmpipe"))
    assert devices.open_device("llvm").egl.index == 0


def test_a_gpu_that_two_drivers_list_by_one_name_is_one_device(monkeypatch):
    monkeypatch.setattr(devices, "egl_devices", lambda: [EglDevice(i) for i in range(2)])
    monkeypatch.setattr(devices, "_create", lambda i: Opened(0, "NVIDIA H200"))
    assert devices.open_device("h200").info["uuid"] == UUIDS[0]


def test_a_software_driver_is_taken_where_no_gpu_can_be_opened(machine, monkeypatch):
    monkeypatch.setattr(devices, "egl_devices", lambda: [EglDevice(0), EglDevice(3)])
    assert devices.open_device("auto").egl.index == 3


@pytest.mark.parametrize(("want", "said"), [
    ("radeon", "--device radeon: no such device; allowed: .* 1 NVIDIA H200; 2 NVIDIA H200; 3 llvmpipe"),
    ("9", "--device 9: no such device"),
    (UUIDS[1][:8], "--device 00000001: no such device"),  # a beginning, which might be a part of a name
    ("1:02:00.0", "--device 1:02:00.0: no such device"), ("0001:02:00.0", "--device 0001:02:00.0: no such device"),
    ("gpu-0000000", f"--device gpu-0000000: is the beginning of several UUIDs; allowed: one of {UUIDS[0]}, {UUIDS[1]}"),
    ("20", "--device 20: no such device"),  # an index that no device has, and a part of two names
    ("", "--device : no such device"), (" ", "--device  : no such device"),  # an unset variable, a part of every name
    ("0", r"--device 0: it cannot be used: eglInitialize failed \(0x3001\); allowed: .* 1 NVIDIA H200; .* 3 llvmpipe"),
])
def test_a_device_that_is_not_there_is_told_with_those_that_are(machine, want, said):
    with pytest.raises(DeviceError, match=said):
        devices.open_device(want)


def test_a_gpu_that_cannot_be_opened_is_told_with_its_reason(machine, monkeypatch):
    monkeypatch.setattr(devices, "egl_devices", lambda: [EglDevice(0), EglDevice(3)])
    with pytest.raises(DeviceError, match=r"gpu: EGL device 0 cannot be used: eglInitialize failed \(0x3001\)"):
        devices.open_device("gpu")


def test_where_no_device_can_be_used_the_error_says_what_to_install(machine, monkeypatch):
    monkeypatch.setattr(devices, "egl_devices", lambda: [EglDevice(0)])
    for want in ("0", "auto"):
        with pytest.raises(DeviceError, match=r"no OpenGL 4\.3 device: EGL device 0: eglInitialize .*; install a"):
            devices.open_device(want)


def test_every_device_is_listed_with_why_it_cannot_be_used(machine):
    listed = devices.list_devices()
    assert [(d.index, d.info.get("renderer"), d.trouble) for d in listed] == [
        (0, None, "eglInitialize failed (0x3001)"), (1, "NVIDIA H200", None), (2, "NVIDIA H200", None),
        (3, "llvmpipe", None)]
    assert listed[0].info["uuid"] == UUIDS[0]
    assert len({d.info["uuid"] for d in listed}) == 4  # equal GPUs are told apart
    assert all(device.released for device in machine)


def test_real_devices_are_listed_in_egls_order(device):
    """Runs in a process of its own: the context of this one has to stay current."""
    listing = """import json
from mfr_bench.gpu.device import list_devices
print(json.dumps([(d.index, d.info) for d in list_devices()]))"""
    ended = subprocess.run([sys.executable, "-c", listing], capture_output=True, text=True, check=True)
    listed = json.loads(ended.stdout)
    assert [index for index, _ in listed] == list(range(len(listed)))
    assert device.info in [info for _, info in listed]
    assert ended.stderr == ""  # no warning of libEGL's


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


def test_the_first_timer_of_a_context_measures_no_distant_past():
    """Runs in a process of its own, whose context is new; an hour is beyond any frame here."""
    timing = """import time
from mfr_bench.gpu import rawgl
from mfr_bench.gpu.device import open_device
gl = open_device().gl
query, start = gl.generate("Queries"), time.perf_counter()
gl.glBeginQuery(rawgl.TIME_ELAPSED, query)
gl.glEndQuery(rawgl.TIME_ELAPSED)
print(gl.query_result(query) / 1e9, time.perf_counter() - start)"""
    ended = subprocess.run([sys.executable, "-c", timing], capture_output=True, text=True, check=True)
    elapsed_s, wall_s = map(float, ended.stdout.split())
    assert elapsed_s <= wall_s
