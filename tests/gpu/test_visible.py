"""GPUs that a scheduler gives: CUDA's numbers, UUIDs and Slurm's GRES, matched with EGL's list."""

from __future__ import annotations

import pytest

from mfr_bench.errors import DeviceError
from mfr_bench.gpu import device as devices
from mfr_bench.gpu import egl
from mfr_bench.gpu import visible as room
from mfr_bench.gpu.egl import EglDevice
from mfr_bench.gpu.visible import Visible, visible

from .test_device import UUIDS, Opened

PCIS = [f"0000:0{i}:00.0" for i in range(4)]


@pytest.fixture
def nvidia(tmp_path):
    """The driver's list: the number of the device file grows against the order of the bus."""
    for minor, pci in ((1, PCIS[0]), (0, PCIS[1]), (2, PCIS[2])):
        (tmp_path / pci).mkdir()
        (tmp_path / pci / "information").write_text(f"Model: \t\t NVIDIA H200\nDevice Minor: \t {minor}\n")
    return tmp_path


@pytest.mark.parametrize(("environ", "expected"), [
    ({}, None),
    ({"CUDA_VISIBLE_DEVICES": ""}, Visible("CUDA_VISIBLE_DEVICES=", nothing=True)),
    ({"CUDA_VISIBLE_DEVICES": "NoDevFiles"}, Visible("CUDA_VISIBLE_DEVICES=NoDevFiles", nothing=True)),
    ({"CUDA_VISIBLE_DEVICES": "-1"}, Visible("CUDA_VISIBLE_DEVICES=-1", nothing=True)),
    ({"CUDA_VISIBLE_DEVICES": "1,0"}, Visible("CUDA_VISIBLE_DEVICES=1,0", numbers=(1, 0))),
    ({"CUDA_VISIBLE_DEVICES": "0", "CUDA_DEVICE_ORDER": "PCI_BUS_ID"},
     Visible("CUDA_VISIBLE_DEVICES=0", pcis=(PCIS[0],), numbers=(0,))),
    ({"CUDA_VISIBLE_DEVICES": "GPU-00000001"}, Visible("CUDA_VISIBLE_DEVICES=GPU-00000001", uuids=("00000001",))),
    ({"CUDA_VISIBLE_DEVICES": "MIG-" + UUIDS[1]}, Visible(f"CUDA_VISIBLE_DEVICES=MIG-{UUIDS[1]}", parts=True)),
    ({"CUDA_VISIBLE_DEVICES": f"MIG-GPU-{UUIDS[1]}/1/0"},
     Visible(f"CUDA_VISIBLE_DEVICES=MIG-GPU-{UUIDS[1]}/1/0", parts=True)),
    ({"SLURM_JOB_GPUS": "0"}, Visible("SLURM_JOB_GPUS=0", pcis=(PCIS[1],))),
    ({"SLURM_JOB_GPUS": "0-1", "SLURM_STEP_GPUS": "1", "CUDA_VISIBLE_DEVICES": "0"},
     Visible("SLURM_STEP_GPUS=1, CUDA_VISIBLE_DEVICES=0", pcis=(PCIS[0],), numbers=(0,))),
    ({"SLURM_JOB_GPUS": "all"}, None),
    ({"SLURM_JOB_GPUS": "7"}, Visible("SLURM_JOB_GPUS=7")),  # a device file that the driver does not list
    ({"SLURM_JOB_GPUS": "0", "CUDA_VISIBLE_DEVICES": ""}, Visible("CUDA_VISIBLE_DEVICES=", nothing=True)),
])
def test_the_environment_says_what_is_given(nvidia, environ, expected):
    assert visible(environ, nvidia) == expected


@pytest.mark.parametrize(("value", "expected"), [
    ("0,-1,1", {"numbers": (0,)}), ("0,,1", {"numbers": (0,)}), (" 2 , 1 ", {"numbers": (2, 1)}),
    ("+1", {"numbers": (1,)}), ("1x,2", {"numbers": (1, 2)}), ("0,gpu-1", {"numbers": (0,)}),
    ("GPU-1,0", {"uuids": ("1",)}), ("GPU-1,MIG-2", {"uuids": ("1",)}), ("GPU-1,gpu-2", {"uuids": ("1", "2")}),
    ("-1,0", {"nothing": True}), ("none", {"nothing": True}), (",0", {"nothing": True}), ("0,0", {"nothing": True}),
    ("GPU-", {"nothing": True}), ("GPU-1,GPU-1", {"nothing": True}),
    (UUIDS[1], {"numbers": (1,)}),  # a UUID begins with GPU-
])
def test_a_list_ends_at_what_cuda_does_not_take(nvidia, value, expected):
    assert visible({"CUDA_VISIBLE_DEVICES": value}, nvidia) == Visible(f"CUDA_VISIBLE_DEVICES={value}", **expected)


@pytest.mark.parametrize(("minors", "value", "pcis"), [
    ("0-2", "0,1,2", set(PCIS[:3])),
    ("1,2", "0", {PCIS[0]}),  # the first of the job's on the bus, since device file 0 is no part of it
    ("1,2", "2", {PCIS[2]}),  # a device file of the job, which has no third
    ("0,1", "0", set()),  # the first of the job's on the bus, or device file 0, which is the second
    ("0,1", "5", set()),
])
def test_a_part_of_a_jobs_gpus_is_told_where_it_can_be_read_in_one_way(nvidia, minors, value, pcis):
    found = visible({"SLURM_JOB_GPUS": minors, "CUDA_VISIBLE_DEVICES": value}, nvidia)
    assert set(found.pcis) == pcis and found.said == f"SLURM_JOB_GPUS={minors}, CUDA_VISIBLE_DEVICES={value}"


@pytest.mark.parametrize(("given", "device", "admitted"), [
    (Visible("", uuids=("00000001",)), (UUIDS[1], None, None), True),
    (Visible("", uuids=("00000001",)), (UUIDS[2], PCIS[1], 1), False),
    (Visible("", uuids=("00000001",)), (None, PCIS[1], 1), None),
    (Visible("", pcis=(PCIS[1],), numbers=(0,)), (UUIDS[1], PCIS[1], 1), True),  # the address, not the number in a job
    (Visible("", pcis=(PCIS[1],), numbers=(0,)), (UUIDS[1], None, 0), True),
    (Visible("", numbers=(1,)), (UUIDS[1], PCIS[1], 0), False),
    (Visible("", numbers=(1,)), (UUIDS[1], PCIS[1], None), None),
    (Visible("", nothing=True), (UUIDS[1], PCIS[1], 0), False),
])
def test_a_gpu_is_given_by_what_the_driver_tells_of_it(given, device, admitted):
    assert given.admits(*device) is admitted


@pytest.fixture
def machine(monkeypatch):
    """Three equal GPUs, which EGL lists against CUDA's numbers, and the software driver."""
    renderers = ["NVIDIA H200"] * 3 + ["llvmpipe"]
    entries = [EglDevice(i, UUIDS[i], PCIS[i], cuda=2 - i if i < 3 else None) for i in range(4)]
    monkeypatch.setattr(devices, "egl_devices", lambda: entries)
    monkeypatch.setattr(devices, "_create", lambda index: Opened(index, renderers[index]))
    for name in ("CUDA_VISIBLE_DEVICES", *room.SLURM):
        monkeypatch.delenv(name, raising=False)
    return entries


@pytest.mark.parametrize(("value", "want", "index"), [
    ("0", "auto", 2), ("2", "gpu", 0), ("GPU-" + UUIDS[1], "auto", 1), ("", "auto", 3), ("0", "cpu", 3), ("0", "1", 1),
    ("0", "h200", 2),
    ("0", "pipe", 3), ("0", UUIDS[0], 0)])
def test_the_given_gpu_is_opened(machine, monkeypatch, value, want, index):
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", value)
    assert devices.open_device(want).egl.index == index


@pytest.mark.parametrize(("value", "want", "said"), [
    ("", "gpu", "CUDA_VISIBLE_DEVICES=: gives this process no GPU"),
    ("GPU-77", "gpu", "CUDA_VISIBLE_DEVICES=GPU-77: gives this process no GPU of those that EGL can open"),
    ("GPU-77", "h200", "CUDA_VISIBLE_DEVICES=GPU-77: gives this process no GPU of those that EGL can open"),
    ("0", "radeon", "--device radeon: no such device"),
    ("MIG-" + UUIDS[0], "gpu", r"a part of a GPU \(MIG\), which has no OpenGL"),
])
def test_what_is_not_there_is_said(machine, monkeypatch, value, want, said):
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", value)
    with pytest.raises(DeviceError, match=said):
        devices.open_device(want)


def test_nothing_is_guessed_where_the_driver_tells_nothing(machine, monkeypatch):
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "1")
    untold = [EglDevice(i) for i in range(4)]
    monkeypatch.setattr(devices, "egl_devices", lambda: untold)
    with pytest.raises(DeviceError, match="which of EGL's devices that is, the driver does not tell"):
        devices.open_device("gpu")
    monkeypatch.setattr(devices, "egl_devices", lambda: untold[2:])  # of one GPU there is nothing to confuse
    assert devices.open_device("gpu").egl.index == 2


def test_egl_tells_the_cuda_number_where_the_driver_has_the_extension(monkeypatch):
    """A libEGL that lists two devices, of which one names the extension."""
    def attribute(handle, name, number):
        number._obj.value = 3
        return name == egl.CUDA_DEVICE

    said = {(1, egl.EXTENSIONS): b"EGL_EXT_device_drm EGL_NV_device_cuda", (2, egl.EXTENSIONS): b"EGL_EXT_device_drm"}
    functions = {"eglQueryDeviceStringEXT": lambda handle, name: said.get((handle, name)),
                 "eglQueryDeviceAttribEXT": attribute, "eglQueryDeviceBinaryEXT": None}
    monkeypatch.setattr(egl, "_function", lambda library, name, *_, **__: functions[name])
    assert [egl._described(None, i, handle).cuda for i, handle in enumerate((1, 2))] == [3, None]
