"""Opens a device: lists those that EGL offers, and finds the one that is meant."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping, Sequence
from ctypes.util import find_library
from dataclasses import dataclass, field

import moderngl

from ..errors import DeviceError, UnknownDeviceError
from . import trials
from .context import Device, Trials
from .egl import EglDevice, egl_devices, is_named, library
from .rawgl import RawGL
from .samplers import Samplers
from .threads import spread_rasterizers
from .vectors import instructions
from .visible import Visible, visible

GL_MINIMUM = 430
KINDS = ("auto", "gpu", "cpu")  # of devices, of which the first is taken
INSTALL = "sudo apt-get install -y libegl1 libgl1 libgl1-mesa-dri"


def _create(index: int) -> Device:
    import glcontext

    backend = glcontext.get_backend_by_name("egl")(
        mode="standalone", glversion=GL_MINIMUM, device_index=index,
        libgl=find_library("GL") or "libGL.so.1", libegl=library())
    ctx = moderngl.create_context(require=GL_MINIMUM, context=backend)
    ctx.enable(moderngl.PROGRAM_POINT_SIZE)
    device = Device(ctx, RawGL(backend.load), backend, Trials(trials.failed, trials.dispatches_need_a_flush))
    device.gl.spend_first_timers()
    device.samplers = Samplers(ctx)
    device.bound_threads = spread_rasterizers()
    device.instructions = instructions() if device.kind == "cpu" else None
    return device


@dataclass(frozen=True)
class Listed:
    """An EGL device, with what it says of itself once it is open, or why it cannot be used."""

    index: int
    info: Mapping[str, str | None]  # of `Device.info`; what EGL alone tells where it cannot be opened
    trouble: str | None = None

    def matches(self, want: str) -> bool:
        """Whether `want` is its kind, or a part of its renderer's name.

        A number of one or two digits is an index alone: names hold such numbers, of versions and of processor cores.
        Blanks, as of a variable that is not set, name nothing.
        """
        if not want.strip() or (want.isdecimal() and len(want) <= 2):
            return False
        return want in ("auto", self.info.get("kind")) or want.lower() in str(self.info.get("renderer", "")).lower()


def list_devices() -> list[Listed]:
    """Every EGL device; each is opened and released."""
    found = []
    for entry in _entries():
        try:
            device = _opened(entry)
        except Exception as error:  # noqa: BLE001 - the bindings raise bare Exception for every cause
            found.append(Listed(entry.index, {"uuid": entry.uuid, "pci": entry.pci}, _why(entry, error)))
            continue
        found.append(Listed(entry.index, device.info))
        device.release()
    return found


def _entries() -> list[EglDevice]:
    """EGL's devices; one to be tried where EGL cannot be asked."""
    try:
        return egl_devices()
    except OSError:
        return [EglDevice(0)]


def _opened(entry: EglDevice) -> Device:
    device = _create(entry.index)
    device.egl = entry
    return device


def _why(entry: EglDevice, error: Exception) -> str:
    """The reason why a device cannot be opened, in one line."""
    reason = " ".join(str(error).split())
    denied = entry.node and os.path.exists(entry.node) and not os.access(entry.node, os.R_OK | os.W_OK)
    return f"{reason} (no permission for {entry.node}: is the user in the group render?)" if denied else reason


def open_device(want: str = "auto") -> Device:
    """Open a headless OpenGL device.

    `want` is `gpu`, `cpu` (a software driver), `auto` (a GPU where there is one), or in this order the index, UUID or
    PCI address of an EGL device (see `is_named`), or a part of its renderer's name. A device that cannot be opened
    hides no other. Of `gpu`, `auto` and a name the GPU is one of those that CUDA_VISIBLE_DEVICES or Slurm give this
    process, if they say anything.

    Raises DeviceError with what to install where there is no driver, and UnknownDeviceError with what there is where
    none matches, or where several have the part of a name.
    """
    entries = _entries()
    exact = _exact(entries, want)
    search = _Search(want, bool(exact), visible(), alone=len(entries) == 1)
    for entry in exact or entries:
        if device := search.device(entry):
            return device
    if second := search.second():
        return _opened(second)
    given = search.given
    if given and (search.barred or want == "gpu"):
        raise _none_given(given, search.tried)
    raise _none_matches(want, list_devices() if exact else search.tried, {e.index for e in exact})


@dataclass
class _Search:
    """The devices that were tried for `want`; exact: it is the index, UUID or PCI address of those that are tried.

    alone: there is no other device. named: those whose names have `want` as a part. unsure: GPUs that match, of which
    nothing tells whether they are given. barred: a GPU matches that is not known to be given. spare: a software driver,
    where a GPU is better.
    """

    want: str
    exact: bool
    given: Visible | None
    alone: bool = False
    tried: list[Listed] = field(default_factory=list)
    named: list[tuple[EglDevice, Listed]] = field(default_factory=list)
    unsure: list[tuple[EglDevice, Listed]] = field(default_factory=list)
    barred: bool = False
    spare: EglDevice | None = None

    def device(self, entry: EglDevice) -> Device | None:
        """The device of an entry, where it is the one that is meant; else it is released."""
        try:
            device = _opened(entry)
        except Exception as error:  # noqa: BLE001 - the bindings raise bare Exception for every cause
            self.tried.append(Listed(entry.index, {}, _why(entry, error)))
            return None
        seen = Listed(entry.index, device.info)
        self.tried.append(seen)
        if self.exact or is_named(self.want, device.info["uuid"], device.info["pci"]):
            return device
        if self._meant(entry, seen):
            if self.alone or self.want in KINDS:
                return device
            self.named.append((entry, seen))
        device.release()
        return None

    def _meant(self, entry: EglDevice, seen: Listed) -> bool:
        """Whether a device matches and is given to this process, as far as that is known."""
        is_gpu = seen.info["kind"] == "gpu"
        if not seen.matches(self.want) or (self.want == "auto" and not is_gpu):
            self.spare = self.spare or (entry if self.want == "auto" else None)
            return False
        known = True if self.given is None or not is_gpu else self.given.admits(seen.info["uuid"], seen.info["pci"],
                                                                               entry.cuda)
        self.unsure += [(entry, seen)] if known is None else []
        self.barred = self.barred or not known
        return bool(known)

    def second(self) -> EglDevice | None:
        """Take the likeliest device where none is surely the one. Raises UnknownDeviceError where several may be."""
        if len({_identity(seen) for _, seen in self.named}) > 1:
            raise _several(self.want, [seen for _, seen in self.named])
        if self.named:
            return self.named[0][0]
        if self.given and len(self.unsure) > 1:
            raise _cannot_tell(self.given, [seen for _, seen in self.unsure])
        return self.unsure[0][0] if self.unsure else self.spare


def _exact(entries: Sequence[EglDevice], want: str) -> list[EglDevice]:
    """The devices that an index, UUID or PCI address names; two drivers may list one GPU.

    Raises UnknownDeviceError where it is the beginning of two UUIDs.
    """
    exact = [e for e in entries if want == str(e.index) or is_named(want, e.uuid, e.pci)]
    uuids = sorted({e.uuid for e in exact if e.uuid})
    if len(uuids) > 1 and any(uuid.startswith(want.lower().removeprefix("gpu-")) for uuid in uuids):
        raise UnknownDeviceError(f"--device {want}: is the beginning of several UUIDs; allowed: one of "
                                 f"{', '.join(uuids)}")
    return exact


def _identity(seen: Listed) -> tuple[str | None, ...]:
    """What differs between two devices: of software drivers of one name, which all use this machine's CPU, nothing."""
    place = seen.info["pci"] or seen.info["uuid"] or str(seen.index)
    return seen.info["renderer"], None if seen.info["kind"] == "cpu" else place


def _several(want: str, named: Sequence[Listed]) -> DeviceError:
    there = "; ".join(" ".join(filter(None, (str(each.index), each.info["renderer"], each.info["pci"])))
                      for each in named)
    return UnknownDeviceError(f"--device {want}: is a part of several names; allowed: more of the name, or an index, "
                              f"UUID or PCI address of one of: {there}; see mfr-bench doctor")


def _cannot_tell(given: Visible, unsure: Sequence[Listed]) -> DeviceError:
    there = "; ".join(f"{each.index} {each.info['renderer']}" for each in unsure)
    return UnknownDeviceError(
        f"{given.said}: which of EGL's devices that is, the driver does not tell (UUID, PCI address, "
        f"EGL_NV_device_cuda); allowed: --device with an index of: {there}; see mfr-bench doctor")


def _none_given(given: Visible, tried: Sequence[Listed]) -> DeviceError:
    if given.parts:
        return DeviceError(f"{given.said}: a part of a GPU (MIG), which has no OpenGL; allowed: a whole GPU")
    there = "; ".join(f"{each.index} {each.info['renderer']}" for each in tried if not each.trouble)
    return UnknownDeviceError(
        f"{given.said}: gives this process no GPU of those that EGL can open ({there or 'none'}); allowed: another "
        "value, --device cpu, or --device with an index, UUID or PCI address")


def _none_matches(want: str, found: Sequence[Listed], named: Collection[int] = ()) -> DeviceError:
    """The error where no device can be opened that matches. `named`: the indices of those that `want` names."""
    usable = [f"{t.index} {t.info['renderer']}" for t in found if not t.trouble]
    if usable:
        which = {t.index: "it" for t in found if t.index in named} or {
            t.index: f"EGL device {t.index}" for t in found if want == "gpu"}
        why = "; ".join(f"{which[t.index]} cannot be used: {t.trouble}" for t in found
                        if t.trouble and t.index in which)
        return UnknownDeviceError(
            f"--device {want}: {why or 'no such device'}; allowed: auto, gpu, cpu, or an index, UUID, PCI address or "
            f"part of the name of one of: {'; '.join(usable)}; see mfr-bench doctor")
    trouble = "; ".join(f"EGL device {t.index}: {t.trouble}" for t in found) or "no EGL device"
    return DeviceError(f"no OpenGL {GL_MINIMUM / 100:.1f} device: {trouble}; install a driver: {INSTALL}")
