"""Every texture unit has the same sampler, whatever method was drawn before."""

import ctypes

from mfr_bench.config.model import Scene
from mfr_bench.gpu.samplers import UNITS

from ..contract.cases import Drawn, catalog

TEXTURE0, SAMPLER_BINDING = 0x84C0, 0x8919


def bound(device) -> list[int]:
    """The sampler at each unit, as OpenGL tells it."""
    address = device.backend.load("glGetIntegerv")
    get = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.POINTER(ctypes.c_int))(address)
    found, value = [], ctypes.c_int()
    for unit in range(UNITS):
        device.gl.glActiveTexture(TEXTURE0 + unit)
        get(SAMPLER_BINDING, ctypes.byref(value))
        found.append(value.value)
    return found


def test_methods_leave_the_sampler_of_every_unit_alone(device):
    sampler, *others = bound(device)
    assert sampler > 0 and set(others) == {sampler}
    for method in ("peel-f2b", "ab-ll", "zbuffer"):
        Drawn(device, catalog()[method].variant({}), Scene(size=(8, 8), depth_complexity=2))
        assert bound(device) == [sampler] * UNITS
