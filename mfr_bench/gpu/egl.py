"""The EGL devices of this machine, as EGL numbers them: also those that no context can be created on."""

from __future__ import annotations

import ctypes
import os
import re
from collections.abc import Callable
from ctypes.util import find_library
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .shader_cache import avoid_full_cache
from .vectors import avoid_high_registers

MOST_DEVICES = 64
DEVICE_UUID, DRM_DEVICE_FILE, DRM_RENDER_NODE = 0x335C, 0x3233, 0x3377
EXTENSIONS, CUDA_DEVICE, CUDA_EXTENSION = 0x3055, 0x323A, "EGL_NV_device_cuda"
UUID_BYTES = 16
PCI = re.compile(r"[0-9a-f]{4}:[0-9a-f]{2}:[0-9a-f]{2}\.[0-7]")
PCI_GIVEN = re.compile(r"(?:([0-9a-f]{4}|[0-9a-f]{8}):)?([0-9a-f]{2}:[0-9a-f]{2}\.[0-7])")  # lspci, nvidia-smi
UUID_GIVEN = re.compile(r"(gpu-)?([0-9a-f][0-9a-f-]*)")  # nvidia-smi writes GPU- before it
LIBRARY = "libEGL.so.1"


@dataclass(frozen=True)
class EglDevice:
    """One entry of EGL's list; None where the driver does not tell. `uuid` is as Vulkan and CUDA write it.

    cuda: its number among CUDA's devices.
    """

    index: int
    uuid: str | None = None
    pci: str | None = None  # domain:bus:device.function
    node: str | None = None  # the device file that a user needs permission for
    cuda: int | None = None


def library() -> str:
    """The name by which libEGL is loaded."""
    return find_library("EGL") or LIBRARY


def egl_devices() -> list[EglDevice]:
    """Every EGL device in EGL's order.

    Without the extensions that list devices, the list is the one default device. Raises OSError where there is no
    libEGL.
    """
    os.environ.setdefault("EGL_LOG_LEVEL", "fatal")  # Mesa 26 warns of LIBGL_ALWAYS_SOFTWARE on stderr
    avoid_high_registers()
    avoid_full_cache()
    egl = ctypes.CDLL(library())
    query = _function(egl, "eglQueryDevicesEXT", ctypes.c_int, ctypes.POINTER(ctypes.c_void_p),
                      ctypes.POINTER(ctypes.c_int))
    if query is None:
        return [EglDevice(0)]
    handles, count = (ctypes.c_void_p * MOST_DEVICES)(), ctypes.c_int()
    if not query(MOST_DEVICES, handles, ctypes.byref(count)):
        return []
    return [_described(egl, index, handles[index]) for index in range(count.value)]


def _function(egl: ctypes.CDLL, name: str, *arguments: Any, result: Any = ctypes.c_uint) -> Callable | None:
    egl.eglGetProcAddress.restype, egl.eglGetProcAddress.argtypes = ctypes.c_void_p, (ctypes.c_char_p,)
    address = egl.eglGetProcAddress(name.encode())
    return ctypes.CFUNCTYPE(result, *arguments)(address) if address else None


def _described(egl: ctypes.CDLL, index: int, handle: int) -> EglDevice:
    text = _function(egl, "eglQueryDeviceStringEXT", ctypes.c_void_p, ctypes.c_int, result=ctypes.c_char_p)
    files = [found.decode() for name in (DRM_RENDER_NODE, DRM_DEVICE_FILE) if text and (found := text(handle, name))]
    return EglDevice(index, _uuid(egl, handle), next(filter(None, map(pci_address, files)), None),
                     files[0] if files else None, _cuda(egl, handle, text))


def _cuda(egl: ctypes.CDLL, handle: int, text: Callable | None) -> int | None:
    """The CUDA number of a device, where EGL_NV_device_cuda tells it."""
    if not text or CUDA_EXTENSION not in (text(handle, EXTENSIONS) or b"").decode().split():
        return None
    attribute = _function(egl, "eglQueryDeviceAttribEXT", ctypes.c_void_p, ctypes.c_int,
                          ctypes.POINTER(ctypes.c_ssize_t))
    number = ctypes.c_ssize_t()
    return int(number.value) if attribute and attribute(handle, CUDA_DEVICE, ctypes.byref(number)) else None


def _uuid(egl: ctypes.CDLL, handle: int) -> str | None:
    binary = _function(egl, "eglQueryDeviceBinaryEXT", ctypes.c_void_p, ctypes.c_int, ctypes.c_int, ctypes.c_void_p,
                       ctypes.POINTER(ctypes.c_int))
    raw, size = (ctypes.c_ubyte * UUID_BYTES)(), ctypes.c_int()
    found = binary and binary(handle, DEVICE_UUID, UUID_BYTES, raw, ctypes.byref(size)) and size.value == UUID_BYTES
    return uuid_text(bytes(raw)) if found else None


def is_named(want: str, uuid: str | None, pci: str | None) -> bool:
    """True where `want` is a device's UUID or PCI address, in either case, as nvidia-smi, lspci or doctor write them.

    GPU- may stand before a UUID, and then it may be the UUID's beginning; the domain of a PCI address may be left out.
    """
    if found := PCI_GIVEN.fullmatch(want.lower()):
        return pci == f"{int(found[1] or '0', 16):04x}:{found[2]}"
    found = UUID_GIVEN.fullmatch(want.lower())
    return bool(found and uuid and (uuid.startswith(found[2]) if found[1] else uuid == found[2]))


def uuid_text(raw: bytes) -> str | None:
    """16 bytes as 8-4-4-4-12 hexadecimal digits; None where all are 0, which names no device."""
    digits = raw.hex()
    return "-".join((digits[:8], digits[8:12], digits[12:16], digits[16:20], digits[20:])) if any(raw) else None


def pci_address(node: str) -> str | None:
    """PCI address behind a device file such as /dev/dri/renderD128; None where it is on another bus."""
    behind = Path("/sys/class/drm") / Path(node).name / "device"
    found = behind.resolve().name
    return found if PCI.fullmatch(found) else None
