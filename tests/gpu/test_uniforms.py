"""Uniform blocks: each that a program declares has a buffer while it runs, whether a shader reads it or not."""

import ctypes

import moderngl
import pytest

from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.glsl.bindings import ALONE_BINDING, ALONE_FIELDS
from mfr_bench.gpu.pass_runner import PassRunner
from mfr_bench.gpu.single import shown
from mfr_bench.methods import catalog
from mfr_bench.scene import generate

BUFFER_BINDING, BUFFER_SIZE = 0x8A28, 0x8A2A  # GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_SIZE


@pytest.fixture
def indexed(device):
    """Reads the state of an indexed binding point."""
    load = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.c_uint, ctypes.POINTER(ctypes.c_int64))(
        device.backend.load("glGetInteger64i_v"))

    def value(name, index):
        found = ctypes.c_int64(-1)
        load(name, index, ctypes.byref(found))
        return found.value
    return value


@pytest.mark.parametrize("name", ["kplus-array", "ab-array", "adaptive", "peel-f2b"])
def test_every_declared_block_is_backed(device, indexed, monkeypatch, name):
    """OpenGL 4.6, section 7.6.3: otherwise the results of the shader are undefined."""
    seen, run = {}, PassRunner.run

    def checked(self, iteration):
        run(self, iteration)
        for block in (self.program[n] for n in self.program) if self.program else ():
            if isinstance(block, moderngl.UniformBlock):
                backed = indexed(BUFFER_BINDING, block.binding) and indexed(BUFFER_SIZE, block.binding)
                seen[self.step.name, block.name] = backed >= block.size
    for index in range(ALONE_BINDING + len(ALONE_FIELDS)):  # what other tests have left
        device.gl.glBindBufferBase(0x8A11, index, 0)
    monkeypatch.setattr(PassRunner, "run", checked)
    with shown(device, generate(SceneConfig(size=(16, 16), depth_complexity=3))) as on:
        on.render(catalog()[name].variant({}))
    assert {block for _, block in seen} >= {"Frame", "Colours"}
    assert any(block.startswith("Alone_") for _, block in seen)
    assert not [where for where, backed in seen.items() if not backed]
