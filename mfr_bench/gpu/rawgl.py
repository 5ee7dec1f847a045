"""The OpenGL calls that moderngl lacks, loaded from the context through ctypes."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

ENUM, UINT, INT, FLOAT, BOOL = ctypes.c_uint, ctypes.c_uint, ctypes.c_int, ctypes.c_float, ctypes.c_ubyte
SIZE, OFFSET, POINTER = ctypes.c_int, ctypes.c_ssize_t, ctypes.c_void_p

BLEND, DEPTH_TEST, STENCIL_TEST, COLOR, DEPTH, DEPTH_STENCIL = 0x0BE2, 0x0B71, 0x0B90, 0x1800, 0x1801, 0x84F9
SCISSOR_TEST, COPY_WRITE_BUFFER, RED_INTEGER, UNSIGNED_INT = 0x0C11, 0x8F37, 0x8D94, 0x1405
TEXTURE_2D, TEXTURE_2D_ARRAY, TEXTURE_2D_MULTISAMPLE, NEAREST = 0x0DE1, 0x8C1A, 0x9100, 0x2600
TEXTURE_MIN_FILTER, TEXTURE_MAG_FILTER = 0x2801, 0x2800
FRAMEBUFFER, FRAMEBUFFER_COMPLETE, COLOR_ATTACHMENT0 = 0x8D40, 0x8CD5, 0x8CE0
DEPTH_ATTACHMENT, DEPTH_STENCIL_ATTACHMENT = 0x8D00, 0x821A
TIMESTAMP, TIME_ELAPSED, SAMPLES_PASSED, QUERY_RESULT = 0x8E28, 0x88BF, 0x8914, 0x8866
READ_FRAMEBUFFER, DRAW_FRAMEBUFFER, COLOR_BUFFER_BIT, SAMPLE_POSITION = 0x8CA8, 0x8CA9, 0x4000, 0x8E50
DEFAULT_WIDTH, DEFAULT_HEIGHT, DEFAULT_SAMPLES, DEFAULT_FIXED_PLACES = 0x9310, 0x9311, 0x9313, 0x9314
TEXTURE0, MULTISAMPLE, TEXTURE_SAMPLES, SAMPLES, NUM_SAMPLE_COUNTS = 0x84C0, 0x809D, 0x9106, 0x80A9, 0x9380

FORMATS = {"r8": 0x8229, "rg8": 0x822B, "rgba8": 0x8058, "r16": 0x822A, "rgba16f": 0x881A, "r32f": 0x822E,
           "rg32f": 0x8230, "rgba32f": 0x8814, "r32ui": 0x8236, "rg32ui": 0x823C, "depth16": 0x81A5, "depth32f": 0x8CAC,
           "depth24_stencil8": 0x88F0}
# Of a texture of a buffer's memory, by the words of an element: R32UI, RG32UI, RGB32UI.
TEXEL_FORMATS = {1: 0x8236, 2: 0x823C, 3: 0x8D71, 4: 0x8D70}
TEXTURE_BUFFER, RGBA, FLOATS = 0x8C2A, 0x1908, 0x1406
POINTS, TRIANGLES, TRIANGLE_STRIP = 0, 4, 5  # what a draw makes of its vertices
EQUATIONS = {"add": 0x8006, "max": 0x8008}
FACTORS = {"zero": 0, "one": 1, "one_minus_src_alpha": 0x0303, "one_minus_dst_alpha": 0x0305, "dst_alpha": 0x0304}
STENCIL_TESTS = {"equal": 0x0202, "always": 0x0207}
STENCIL_UPDATES = {"increment": 0x1E02, "decrement": 0x1E03}  # both clamp
DEPTH_FUNCTIONS = {"less": 0x0201, "equal": 0x0202, "lequal": 0x0203, "always": 0x0207}
# `image`: shader image access, fetches from textures, and everything done through framebuffers.
# `indirect`: commands and vertex attributes that come from buffers. `texels`: fetches alone, from textures of buffers.
BARRIERS = {"storage": 0x2000 | 0x1000, "texels": 0x8, "buffer_update": 0x200, "image": 0x20 | 0x8 | 0x400,
            "indirect": 0x40 | 0x1}
WRITE_ONLY, DEVICE_UUID = 0x88B9, 0x9597
ATOMIC_COUNTER_BUFFER = 0x92C0
LOWER_LEFT, NEGATIVE_ONE_TO_ONE, ZERO_TO_ONE = 0x8CA1, 0x935E, 0x935F
ERRORS = {0x0500: "GL_INVALID_ENUM", 0x0501: "GL_INVALID_VALUE", 0x0502: "GL_INVALID_OPERATION",
          0x0505: "GL_OUT_OF_MEMORY", 0x0506: "GL_INVALID_FRAMEBUFFER_OPERATION", 0x0507: "GL_CONTEXT_LOST"}

_SIGNATURES: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "glEnable": (None, (ENUM,)),
    "glDisable": (None, (ENUM,)),
    "glBlendEquation": (None, (ENUM,)),
    "glBlendFuncSeparate": (None, (ENUM, ENUM, ENUM, ENUM)),
    "glBlendEquationi": (None, (UINT, ENUM)),
    "glBlendFunci": (None, (UINT, ENUM, ENUM)),
    "glDepthFunc": (None, (ENUM,)),
    "glStencilFunc": (None, (ENUM, INT, UINT)),
    "glStencilOp": (None, (ENUM, ENUM, ENUM)),
    "glDepthMask": (None, (BOOL,)),
    "glColorMask": (None, (BOOL, BOOL, BOOL, BOOL)),
    "glColorMaski": (None, (UINT, BOOL, BOOL, BOOL, BOOL)),
    "glScissor": (None, (INT, INT, SIZE, SIZE)),
    "glBindBuffer": (None, (ENUM, UINT)),
    "glBindBufferBase": (None, (ENUM, UINT, UINT)),
    "glClearBufferSubData": (None, (ENUM, ENUM, OFFSET, OFFSET, ENUM, ENUM, POINTER)),
    "glViewport": (None, (INT, INT, SIZE, SIZE)),
    "glClearBufferfv": (None, (ENUM, INT, ctypes.POINTER(FLOAT))),
    "glClearBufferuiv": (None, (ENUM, INT, ctypes.POINTER(UINT))),
    "glClearBufferfi": (None, (ENUM, INT, FLOAT, INT)),
    "glGenTextures": (None, (SIZE, ctypes.POINTER(UINT))),
    "glDeleteTextures": (None, (SIZE, ctypes.POINTER(UINT))),
    "glActiveTexture": (None, (ENUM,)),
    "glBindTexture": (None, (ENUM, UINT)),
    "glTexBuffer": (None, (ENUM, ENUM, UINT)),
    "glTexStorage2D": (None, (ENUM, SIZE, ENUM, SIZE, SIZE)),
    "glTexStorage3D": (None, (ENUM, SIZE, ENUM, SIZE, SIZE, SIZE)),
    "glTexStorage2DMultisample": (None, (ENUM, SIZE, ENUM, SIZE, SIZE, BOOL)),
    "glGetTexLevelParameteriv": (None, (ENUM, INT, ENUM, ctypes.POINTER(INT))),
    "glGetInternalformativ": (None, (ENUM, ENUM, ENUM, SIZE, ctypes.POINTER(INT))),
    "glBindImageTexture": (None, (UINT, UINT, INT, BOOL, INT, ENUM, ENUM)),
    "glTexParameteri": (None, (ENUM, ENUM, INT)),
    "glGenFramebuffers": (None, (SIZE, ctypes.POINTER(UINT))),
    "glDeleteFramebuffers": (None, (SIZE, ctypes.POINTER(UINT))),
    "glBindFramebuffer": (None, (ENUM, UINT)),
    "glFramebufferTexture": (None, (ENUM, ENUM, UINT, INT)),
    "glFramebufferTextureLayer": (None, (ENUM, ENUM, UINT, INT, INT)),
    "glDrawBuffers": (None, (SIZE, ctypes.POINTER(ENUM))),
    "glReadBuffer": (None, (ENUM,)),
    "glReadPixels": (None, (INT, INT, SIZE, SIZE, ENUM, ENUM, POINTER)),
    "glCheckFramebufferStatus": (ENUM, (ENUM,)),
    "glFramebufferParameteri": (None, (ENUM, ENUM, INT)),
    "glBlitFramebuffer": (None, (INT,) * 8 + (UINT, ENUM)),
    "glGetMultisamplefv": (None, (ENUM, UINT, ctypes.POINTER(FLOAT))),
    "glGenQueries": (None, (SIZE, ctypes.POINTER(UINT))),
    "glDeleteQueries": (None, (SIZE, ctypes.POINTER(UINT))),
    "glBeginQuery": (None, (ENUM, UINT)),
    "glEndQuery": (None, (ENUM,)),
    "glQueryCounter": (None, (UINT, ENUM)),
    "glGetQueryObjectui64v": (None, (UINT, ENUM, ctypes.POINTER(ctypes.c_uint64))),
    "glMemoryBarrier": (None, (UINT,)),
    "glDispatchCompute": (None, (UINT, UINT, UINT)),
    "glFlush": (None, ()),
    "glFinish": (None, ()),
    "glGetError": (ENUM, ()),
}
_OPTIONAL: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "glClipControl": (None, (ENUM, ENUM)),  # OpenGL 4.5
    "glGetUnsignedBytei_vEXT": (None, (ENUM, UINT, ctypes.POINTER(BOOL))),  # GL_EXT_memory_object
}


class RawGL:
    """Attributes are GL functions of the current context, e.g. `gl.glFinish()`; an optional one may be None."""

    def __init__(self, load):
        for name, (result, arguments) in _SIGNATURES.items():
            address = load(name)
            if not address:
                raise OSError(f"the driver has no {name}")
            setattr(self, name, ctypes.CFUNCTYPE(result, *arguments)(address))
        for name, (result, arguments) in _OPTIONAL.items():
            address = load(name)
            setattr(self, name, ctypes.CFUNCTYPE(result, *arguments)(address) if address else None)

    def generate(self, kind: str) -> int:
        """A new object name of kind Textures, Framebuffers or Queries."""
        name = UINT()
        getattr(self, f"glGen{kind}")(1, ctypes.byref(name))
        return name.value

    def delete(self, kind: str, name: int) -> None:
        getattr(self, f"glDelete{kind}")(1, ctypes.byref(UINT(name)))

    def clear(self, buffer: int, index: int, values: tuple[float, ...]) -> None:
        self.glClearBufferfv(buffer, index, (FLOAT * len(values))(*values))

    def clear_whole(self, buffer: int, index: int, values: tuple[float, ...]) -> None:
        """Clear a colour of unsigned whole numbers: to its channels, or to one value in all of them."""
        channels = (int(values[0]),) * 4 if len(values) == 1 else (*map(int, values), 0, 0, 0)[:4]
        self.glClearBufferuiv(buffer, index, (UINT * 4)(*channels))

    def clip_depths_from_zero(self, wanted: bool) -> None:
        """Let clip space reach from depth 0 to 1, which keeps every bit of a float, or from -1 to 1."""
        if self.glClipControl:
            self.glClipControl(LOWER_LEFT, ZERO_TO_ONE if wanted else NEGATIVE_ONE_TO_ONE)

    def zero(self, buffer: int, size: int) -> None:
        """Set the first `size` bytes of a buffer to 0."""
        self.glBindBuffer(COPY_WRITE_BUFFER, buffer)
        self.glClearBufferSubData(COPY_WRITE_BUFFER, FORMATS["r32ui"], 0, size, RED_INTEGER, UNSIGNED_INT, None)

    def device_uuid(self) -> bytes:
        """16 bytes, zero where the driver does not report them."""
        raw = (BOOL * 16)()
        if self.glGetUnsignedBytei_vEXT:
            self.glGetUnsignedBytei_vEXT(DEVICE_UUID, 0, raw)
            self.glGetError()
        return bytes(raw)

    def sample_counts(self, format: str) -> frozenset[int]:
        """The numbers of samples that multisample textures of a format can have."""
        count = INT()
        self.glGetInternalformativ(TEXTURE_2D_MULTISAMPLE, FORMATS[format], NUM_SAMPLE_COUNTS, 1, ctypes.byref(count))
        found = (INT * max(1, count.value))()
        self.glGetInternalformativ(TEXTURE_2D_MULTISAMPLE, FORMATS[format], SAMPLES, count.value, found)
        return frozenset(found[:count.value])

    def texture_samples(self, target: int) -> int:
        """Samples that the bound texture really has: a driver may give more than were asked for."""
        count = INT()
        self.glGetTexLevelParameteriv(target, 0, TEXTURE_SAMPLES, ctypes.byref(count))
        return count.value

    def spend_first_timers(self) -> None:
        """Take the first timer queries of a context and throw them away: llvmpipe's measure from a distant past."""
        elapsed, stamp = self.generate("Queries"), self.generate("Queries")
        self.glBeginQuery(TIME_ELAPSED, elapsed)
        self.glEndQuery(TIME_ELAPSED)
        self.glQueryCounter(stamp, TIMESTAMP)
        for query in (elapsed, stamp):
            self.query_result(query)
            self.delete("Queries", query)

    def query_result(self, query: int) -> int:
        """Result of a query, 64 bits; waits for it."""
        result = ctypes.c_uint64()
        self.glGetQueryObjectui64v(query, QUERY_RESULT, ctypes.byref(result))
        return result.value

    def samples_passed(self, draw: Callable[[], object]) -> int:
        """Samples that pass all tests while `draw` draws."""
        query = self.generate("Queries")
        self.glBeginQuery(SAMPLES_PASSED, query)
        draw()
        self.glEndQuery(SAMPLES_PASSED)
        passed = self.query_result(query)
        self.delete("Queries", query)
        return passed

    def error(self) -> str | None:
        """The oldest error not yet read, by name."""
        code = self.glGetError()
        return ERRORS.get(code, hex(code)) if code else None
