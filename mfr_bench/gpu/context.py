"""An open OpenGL device: its context, what it can do, and the programs compiled on it."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property

import moderngl

from ..environment import draws_in_software, processor
from ..errors import DeviceError, ShaderError
from ..glsl import FEATURE_EXTENSIONS, StageSource
from ..methods.spec import LISTED, MSAA_FEATURES, NEAREST_33, SAMPLE_FEATURES, SAMPLE_STENCIL, TILE_POINTS
from ..plan import Limits
from .egl import EglDevice, uuid_text
from .programs import MOST, MOST_LAYERED, Programs
from .rawgl import RawGL
from .samplers import Samplers

SOFTWARE_LOCAL_ARRAY = 1024  # fragments: llvmpipe takes seconds to compile it, and minutes for twice as many
# Drivers that translate to another one, as they write it: zink Vulkan 1.4(NAME), D3D12 (NAME), virgl (NAME), and
# Vulkan's below zink, which say so in NAME: Virtio-GPU Venus (NAME), Microsoft Direct3D12 (NAME).
LAYERED = re.compile(r"(?P<layer>zink|d3d12|virgl|virtio-gpu venus|microsoft direct3d12)\b[^(]*\((?P<under>.+)\)\s*$")
MOST_ERRORS = 16  # that GL remembers; a lost context has one without end


@dataclass(frozen=True)
class Trials:
    """The way to find out what the driver gets wrong. Trials draw on it, so they are given by whoever opens it.

    failed: of each offered feature that is wanted and that a trial finds wrong, the trial and what it found.
    dispatches_need_a_flush: whether draws are right after a dispatch only behind a flush.
    """

    failed: Callable[[Device], dict[str, str]]
    dispatches_need_a_flush: Callable[[Device], bool]


@dataclass
class Device:
    """A context with its limits. `kind` is gpu or cpu.

    bound_threads: threads of a software driver that have processors of their own. instructions: the newest instruction
    set that a software driver of Mesa may use; None: the processor's. samplers: those at the texture units.
    times_frames: whether the time of frames that are made from now on counts, or their images alone. wanted: the
    features that are tried and may be used; None: all.
    """

    ctx: moderngl.Context
    gl: RawGL
    backend: object  # keeps the native context alive
    trials: Trials
    egl: EglDevice = field(default_factory=lambda: EglDevice(0))
    programs: Programs = field(init=False)
    bound_threads: int = 0
    instructions: str | None = None
    samplers: Samplers | None = None
    times_frames: bool = True
    wanted: frozenset[str] | None = None

    def __post_init__(self) -> None:
        layered = LAYERED.match(str(self.ctx.info["GL_RENDERER"]).lower())
        self.programs = Programs(MOST_LAYERED if layered else MOST)

    @cached_property
    def info(self) -> dict[str, str | None]:
        """Renderer, vendor and version strings, and the slug that names result folders.

        `uuid` and `pci` tell equal GPUs apart, which share a slug; None where the driver does not tell them. What a
        software driver renders on is the processor: it is part of the renderer's name.
        """
        renderer = str(self.ctx.info["GL_RENDERER"])
        on = processor() if self.kind == "cpu" else ""
        return {"renderer": f"{renderer} on {on}" if on else renderer, "vendor": str(self.ctx.info["GL_VENDOR"]),
                "version": str(self.ctx.info["GL_VERSION"]), "kind": self.kind,
                "uuid": self.egl.uuid or self._uuid, "pci": self.egl.pci,
                "slug": f"{slug(renderer)}-{slug(on)}" if on else slug(renderer)}

    @property
    def _uuid(self) -> str | None:
        """The device's UUID by GL, which Vulkan and CUDA give it as well."""
        return uuid_text(self.gl.device_uuid()) if "GL_EXT_memory_object" in self.extensions else None

    @property
    def kind(self) -> str:
        return "cpu" if draws_in_software(str(self.ctx.info["GL_RENDERER"])) else "gpu"

    @cached_property
    def extensions(self) -> frozenset[str]:
        return frozenset(self.ctx.extensions)

    @cached_property
    def offered(self) -> frozenset[str]:
        """Features that the driver claims, by an extension of `glsl.FEATURE_EXTENSIONS`, a number, or OpenGL."""
        shading = {f for f, names in FEATURE_EXTENSIONS.items() if self.extensions.intersection(names)}
        samples = {f for f, count in SAMPLE_FEATURES.items() if count in self._sample_counts}
        routing = {SAMPLE_STENCIL} if "samples_4" in samples else set()
        points = {TILE_POINTS} if self.ctx.info["GL_POINT_SIZE_RANGE"][1] >= LISTED else set()
        return frozenset(shading | samples | routing | points | self._rasterized_samples | {NEAREST_33})

    @cached_property
    def failed_trials(self) -> dict[str, str]:
        """The trial that found an offered feature wrong, and what it found, by feature."""
        return self.trials.failed(self)

    @property
    def features(self) -> frozenset[str]:
        """Features that this device offers, that are wanted, and that pass the trial which they have in `trials`."""
        return frozenset(filter(self.wants, self.offered - self.failed_trials.keys()))

    def wants(self, feature: str) -> bool:
        """Whether a feature is tried, and may be used where it passes."""
        return self.wanted is None or feature in self.wanted

    @cached_property
    def flushes_dispatches(self) -> bool:
        """Whether draws are right after a dispatch only behind a flush, by trials."""
        return self.trials.dispatches_need_a_flush(self)

    @property
    def compiles_opaque_twice(self) -> bool:
        """Whether the driver compiles a program that hides what is below it a second time, for blocks that it covers.

        llvmpipe does, itself and below a layered driver: sorts in registers take LLVM 0.2 to 0.7 s each time.
        """
        return "llvmpipe" in str(self.ctx.info["GL_RENDERER"]).lower()

    @property
    def subpixel_bits(self) -> int:
        """The device rasterizes on a grid of 2^-subpixel_bits pixels."""
        return int(self.ctx.info["GL_SUBPIXEL_BITS"])

    @property
    def _rasterized_samples(self) -> set[str]:
        """Features of rasterizing scenes into so many samples, with an image of as many or without attachments."""
        most = int(self.ctx.info["GL_MAX_FRAMEBUFFER_SAMPLES"])
        offered = self.gl.sample_counts("rgba32f")
        return {feature for count, feature in MSAA_FEATURES.items() if count in offered and count <= most}

    @cached_property
    def _sample_counts(self) -> frozenset[int]:
        """Samples that both kinds of target used for stencil routing can have."""
        most = min(int(self.ctx.info[f"GL_MAX_{kind}_SAMPLES"]) for kind in ("INTEGER", "DEPTH_TEXTURE"))
        both = self.gl.sample_counts("r32ui") & self.gl.sample_counts("depth24_stencil8")
        return frozenset(count for count in both if count <= most)

    @property
    def missing_features(self) -> frozenset[str]:
        return frozenset({*FEATURE_EXTENSIONS, *SAMPLE_FEATURES, SAMPLE_STENCIL, TILE_POINTS, NEAREST_33,
                          *MSAA_FEATURES.values()}) - self.features

    @property
    def max_block_bytes(self) -> int:
        """Bytes of the largest storage block. Trials may ask for it, unlike for the limits, which depend on them."""
        return int(self.ctx.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"])

    @property
    def max_texels(self) -> int:
        """Elements of the largest buffer that shaders can read through a texture."""
        return int(self.ctx.info["GL_MAX_TEXTURE_BUFFER_SIZE"])

    @cached_property
    def limits(self) -> Limits:
        info = self.ctx.info
        return Limits(features=self.features, failed_trials=self.failed_trials,
                      max_block_bytes=self.max_block_bytes,
                      max_texture_size=int(info["GL_MAX_TEXTURE_SIZE"]),
                      max_local_array=SOFTWARE_LOCAL_ARRAY if self.kind == "cpu" else None)

    def program(self, sources: tuple[StageSource, ...], owner: str):
        """The linked program of the stages, compiled unless kept. `owner` (method and pass) is named in errors."""
        return self.programs.get(tuple(s.compiled for s in sources), lambda: self._compile(sources, owner))

    def _compile(self, sources: tuple[StageSource, ...], owner: str):
        try:
            return self._link(sources, [s.compiled for s in sources])
        except moderngl.Error as error:
            log = self._log_by_line(sources) or str(error)
        raise ShaderError(compile_message(log, sources, owner))

    def _log_by_line(self, sources: tuple[StageSource, ...]) -> str | None:
        """The compiler's log of the whole text, which has the lines of files; None where that compiles."""
        try:
            self._link(sources, [s.text for s in sources])
        except moderngl.Error as error:
            return str(error)
        return None

    def _link(self, sources: tuple[StageSource, ...], texts: Sequence[str]):
        if sources[0].entry.endswith(".comp"):
            return self.ctx.compute_shader(texts[0])
        kinds = {"vert": "vertex_shader", "frag": "fragment_shader"}
        return self.ctx.program(**{kinds[s.entry.rsplit(".", 1)[1]]: text
                                   for s, text in zip(sources, texts, strict=True)})

    def finish(self) -> None:
        self.gl.glFinish()

    def settle(self) -> None:
        """Leave the samplers as every frame should find them, see `samplers`; not while frames are timed."""
        if self.samplers:
            self.samplers.settle()

    def check(self, doing: str) -> None:
        """Raise what GL has to complain of."""
        if error := self.gl.error():
            if error == "GL_OUT_OF_MEMORY":
                raise MemoryError(f"{doing}: {error}")
            raise DeviceError(f"{doing}: {error}")

    def alive(self) -> bool:
        """Whether the device still works after an error that it may have caused; clears the GL error."""
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


def compile_message(log: str, sources: tuple[StageSource, ...], owner: str) -> str:
    """One line: file, line, what the compiler says, the method and pass, the defines."""
    stage = next((s for s in sources if s.entry.endswith(".vert") == ("vertex_shader" in log)), sources[-1])
    located = stage.located(log)
    files = "|".join(re.escape(f) for f in stage.files)
    first = next((line for line in located.splitlines() if re.match(rf"({files}):\d+", line)),
                 " ".join(located.split()))
    defines = " ".join(f"{m[1]}={m[2]}" for m in re.finditer(r"^#define (\w+) (\d+u?)$", stage.text, re.MULTILINE))
    return f"{first.strip()} ({owner}; {defines})"


def slug(renderer: str) -> str:
    """Folder name of a renderer: `NVIDIA H200/PCIe/SSE2` -> `nvidia-h200`, `llvmpipe (LLVM 15)` -> `llvmpipe`.

    A layered driver's is followed by that of what it renders on: `zink Vulkan 1.4(llvmpipe (…))` -> `zink-llvmpipe`.
    """
    bare = re.sub(r"\((r|tm)\)", "", renderer.lower())
    if layered := LAYERED.match(bare):
        return f"{layered['layer'].replace(' ', '-')}-{slug(layered['under'])}"
    return re.sub(r"[^a-z0-9]+", "-", re.split(r"[(/]", bare)[0]).strip("-") or "unknown"
