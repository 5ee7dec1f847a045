"""One OpenGL device: its context, what it can do, and the programs compiled on it."""

from __future__ import annotations

import os
import re
from contextlib import suppress
from ctypes.util import find_library
from dataclasses import dataclass, field
from functools import cached_property

import moderngl

from ..environment import draws_in_software, processor
from ..errors import DeviceError, ShaderError
from ..glsl import FEATURE_EXTENSIONS, Source
from ..methods.spec import LISTED, SAMPLE_FEATURES, SAMPLE_STENCIL, TILE_POINTS
from ..plan import Limits
from .rawgl import RawGL

GL_MINIMUM = 430
SOFTWARE_LOCAL_ARRAY = 1024  # fragments: llvmpipe takes seconds to compile it, and minutes for twice as many
INSTALL = "sudo apt-get install -y libegl1 libgl1 libgl1-mesa-dri"
MESA_VENDOR = "/usr/share/glvnd/egl_vendor.d/50_mesa.json"
MOST_DEVICES = 16
MOST_ERRORS = 16  # that GL remembers; a lost context has one without end


@dataclass
class Device:
    """A context with its limits. `kind` is gpu or cpu."""

    ctx: moderngl.Context
    gl: RawGL
    backend: object  # keeps the native context alive
    programs: dict[tuple[str, ...], object] = field(default_factory=dict)

    @cached_property
    def info(self) -> dict[str, str]:
        """Renderer, vendor and version strings, and the slug that names result folders.

        What a software driver renders on is the processor: it is part of the renderer's name.
        """
        renderer = str(self.ctx.info["GL_RENDERER"])
        on = processor() if self.kind == "cpu" else ""
        return {"renderer": f"{renderer} on {on}" if on else renderer, "vendor": str(self.ctx.info["GL_VENDOR"]),
                "version": str(self.ctx.info["GL_VERSION"]), "kind": self.kind,
                "slug": f"{slug(renderer)}-{slug(on)}" if on else slug(renderer)}

    @property
    def kind(self) -> str:
        return "cpu" if draws_in_software(str(self.ctx.info["GL_RENDERER"])) else "gpu"

    @cached_property
    def extensions(self) -> frozenset[str]:
        return frozenset(self.ctx.extensions)

    @cached_property
    def features(self) -> frozenset[str]:
        """Features that this device offers, by an extension of `glsl.FEATURE_EXTENSIONS`, a number, or a trial."""
        from .selftest import tests_each_sample  # itself draws on a device

        shading = {f for f, names in FEATURE_EXTENSIONS.items() if self.extensions.intersection(names)}
        samples = {f for f, count in SAMPLE_FEATURES.items() if count in self._sample_counts}
        routing = {SAMPLE_STENCIL} if "samples_4" in samples and tests_each_sample(self) else set()
        points = {TILE_POINTS} if self.ctx.info["GL_POINT_SIZE_RANGE"][1] >= LISTED else set()
        return frozenset(shading | samples | routing | points)

    @cached_property
    def _sample_counts(self) -> frozenset[int]:
        """Samples that both kinds of target used for stencil routing can have."""
        most = min(int(self.ctx.info[f"GL_MAX_{kind}_SAMPLES"]) for kind in ("INTEGER", "DEPTH_TEXTURE"))
        both = self.gl.sample_counts("r32ui") & self.gl.sample_counts("depth24_stencil8")
        return frozenset(count for count in both if count <= most)

    @property
    def missing_features(self) -> frozenset[str]:
        return frozenset({*FEATURE_EXTENSIONS, *SAMPLE_FEATURES, SAMPLE_STENCIL, TILE_POINTS}) - self.features

    @cached_property
    def limits(self) -> Limits:
        info = self.ctx.info
        return Limits(features=self.features, max_block_bytes=int(info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"]),
                      max_texture_size=int(info["GL_MAX_TEXTURE_SIZE"]),
                      max_local_array=SOFTWARE_LOCAL_ARRAY if self.kind == "cpu" else None)

    def program(self, sources: tuple[Source, ...], owner: str):
        """The linked program of the stages, compiled once. `owner` (method and pass) is named in errors."""
        key = tuple(s.code for s in sources)
        if key not in self.programs:
            self.programs[key] = self._compile(sources, owner)
        return self.programs[key]

    def _compile(self, sources: tuple[Source, ...], owner: str):
        texts = {"vert": "vertex_shader", "frag": "fragment_shader"}
        try:
            if sources[0].entry.endswith(".comp"):
                return self.ctx.compute_shader(sources[0].text)
            return self.ctx.program(**{texts[s.entry.rsplit(".", 1)[1]]: s.text for s in sources})
        except moderngl.Error as error:
            raise ShaderError(compile_message(str(error), sources, owner)) from None

    def finish(self) -> None:
        self.gl.glFinish()

    def check(self, doing: str) -> None:
        """Raise what GL has to complain of."""
        if error := self.gl.error():
            if error == "GL_OUT_OF_MEMORY":
                raise MemoryError(f"{doing}: {error}")
            raise DeviceError(f"{doing}: {error}")

    def alive(self) -> bool:
        """Whether the device still does as it is told, after an error that may have been its own; forgets GL's."""
        for _ in range(MOST_ERRORS):
            if not self.gl.error():
                break
        with suppress(Exception):
            probe = self.ctx.buffer(b"alive")
            answer = probe.read()
            probe.release()
            return answer == b"alive" and not self.gl.error()
        return False

    def release(self) -> None:
        with suppress(Exception):
            self.ctx.release()


def compile_message(log: str, sources: tuple[Source, ...], owner: str) -> str:
    """One line: file, line, what the compiler says, the method and pass, the defines."""
    stage = next((s for s in sources if s.entry.endswith(".vert") == ("vertex_shader" in log)), sources[-1])
    located = stage.located(log)
    files = "|".join(re.escape(f) for f in stage.files)
    first = next((line for line in located.splitlines() if re.match(rf"({files}):\d+", line)),
                 " ".join(located.split()))
    defines = " ".join(f"{m[1]}={m[2]}" for m in re.finditer(r"^#define (\w+) (\d+u?)$", stage.text, re.MULTILINE))
    return f"{first.strip()} ({owner}; {defines})"


def slug(renderer: str) -> str:
    """Folder name of a renderer: `NVIDIA H200/PCIe/SSE2` -> `nvidia-h200`, `llvmpipe (LLVM 15)` -> `llvmpipe`."""
    bare = re.sub(r"\((r|tm)\)", "", renderer.lower())
    return re.sub(r"[^a-z0-9]+", "-", re.split(r"[(/]", bare)[0]).strip("-") or "unknown"


def _create(index: int) -> Device:
    import glcontext

    backend = glcontext.get_backend_by_name("egl")(
        mode="standalone", glversion=GL_MINIMUM, device_index=index,
        libgl=find_library("GL") or "libGL.so.1", libegl=find_library("EGL") or "libEGL.so.1")
    ctx = moderngl.create_context(require=GL_MINIMUM, context=backend)
    ctx.enable(moderngl.PROGRAM_POINT_SIZE)
    return Device(ctx, RawGL(backend.load), backend)


def open_device(want: str = "auto") -> Device:
    """Open a headless OpenGL device: `gpu`, `cpu` (a software driver), or `auto`, a GPU where there is one.

    Raises DeviceError with what to install where there is no driver or none of the wanted kind.
    """
    if want == "cpu" and os.path.exists(MESA_VENDOR):
        os.environ.setdefault("__EGL_VENDOR_LIBRARY_FILENAMES", MESA_VENDOR)
        os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")
    spare: Device | None = None
    trouble = "no EGL device"
    for index in range(MOST_DEVICES):
        try:
            device = _create(index)
        except Exception as error:  # noqa: BLE001 - the bindings raise bare Exception for every cause
            trouble = " ".join(str(error).split()) if index == 0 else trouble
            break
        if want == device.kind or (want == "auto" and device.kind == "gpu"):
            return device
        if spare is None:
            spare = device
    if spare is not None and want == "auto":
        return _create(0) if spare.kind == "cpu" else spare
    if spare is not None:
        raise DeviceError(f"--device {want}: only {spare.info['renderer']} is here, a {spare.kind}; use --device auto")
    raise DeviceError(f"no OpenGL {GL_MINIMUM / 100:.1f} device: {trouble}; install a driver: {INSTALL}")
