"""The environment that a measurement depends on: machine, driver, versions, load, clocks. Unknown is None, not 0."""

from __future__ import annotations

import os
import platform
import re
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from . import __version__

MIB = 2**20  # bytes; memory is configured and shown in it
PACKAGES = ("moderngl", "glcontext", "numpy", "flip-evaluator")
PASSING = ("start", "end")  # parts of an environment that differ from run to run of one machine

NVIDIA_FIELDS = {"name": str, "driver_version": str, "pstate": str, "clocks.sm": float, "clocks.mem": float,
                 "clocks.max.sm": float, "temperature.gpu": float, "power.draw": float,
                 "clocks_throttle_reasons.active": str}  # MHz, MHz, MHz, degrees Celsius, W
THROTTLE_REASONS = {0x1: "idle", 0x2: "applications clocks setting", 0x4: "software power cap",
                    0x8: "hardware slowdown", 0x10: "sync boost", 0x20: "software thermal slowdown",
                    0x40: "hardware thermal slowdown", 0x80: "hardware power brake",
                    0x100: "display clock setting"}  # bits of nvmlClocksThrottleReasons, nvml.h
PATIENCE_S = 5.0  # for git and nvidia-smi
MOST_SLOWNESS = 20.0  # times as long as on a quiet machine
START_S = 0.2  # of processor time: with less, wall time over it tells nothing of the machine

SOFTWARE_RENDERERS = re.compile(r"llvmpipe|softpipe|swrast|swiftshader|software", re.IGNORECASE)

Run = Callable[[Sequence[str]], "str | None"]


def ask(command: Sequence[str]) -> str | None:
    """The output of a program; None where it is missing, fails, or does not answer in time."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    except (OSError, subprocess.SubprocessError, UnicodeDecodeError):
        return None
    return done.stdout if done.returncode == 0 else None


def draws_in_software(renderer: str) -> bool:
    """Whether the name of a GL renderer is that of a driver that draws on the CPU."""
    return bool(SOFTWARE_RENDERERS.search(renderer))


def versions() -> dict[str, str | None]:
    """The versions of this program, Python, the system, and the packages that measure."""
    return {"mfr-bench": __version__, "python": platform.python_version(), "system": platform.platform(),
            **{name: _version(name) for name in PACKAGES}}


def _version(package: str) -> str | None:
    from importlib.metadata import PackageNotFoundError, version  # which every process would wait for at its start

    try:
        return version(package)
    except PackageNotFoundError:
        return None


def lasting(device: Mapping[str, str], run: Run = ask) -> dict[str, Any]:
    """The facts that stay as they are for a run: device and driver, CPU, kernel, the program's revision.

    `device` holds the GL strings: renderer, vendor, version.
    """
    return {"gpu": device.get("renderer"), "vendor": device.get("vendor"), "gl": device.get("version"),
            "mesa": mesa(device.get("version") or ""), "cpu": cpu_model(_read("/proc/cpuinfo")),
            "cores": usable_cores(), "kernel": platform.release() or None,
            "revision": revision(Path(__file__).parent, run)}


def passing(device: Mapping[str, str], run: Run = ask) -> dict[str, Any]:
    """The state that changes meanwhile: load averages of 1, 5 and 15 minutes; the GPU's, if the driver reports it."""
    return {"load": load(), "gpu": nvidia(device, run)}


def at_the_start(device: Mapping[str, str]) -> dict[str, Any]:
    """The environment of a run; its end is added when it comes, as `end`."""
    return lasting(device) | {"start": passing(device)}


def load() -> list[float] | None:
    try:
        return [round(average, 2) for average in os.getloadavg()]
    except OSError:
        return None


def slowness() -> float:
    """How many times as long as on a quiet machine this process has taken until now, if it has waited for nothing."""
    spent_s, worked_s = time.monotonic() - started(), time.process_time()
    return min(MOST_SLOWNESS, max(1.0, spent_s / max(START_S, worked_s)))


def started() -> float:
    """The start of this process, in s of the monotonic clock; at the latest as long ago as its processor time."""
    try:
        ticks = int(Path("/proc/self/stat").read_text().rpartition(")")[2].split()[19])
        since_boot_s = float(Path("/proc/uptime").read_text().split()[0]) - ticks / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, IndexError):
        since_boot_s = 0.0
    return time.monotonic() - max(since_boot_s, time.process_time())


def usable_cores() -> int | None:
    """Cores that this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()


def processor() -> str:
    """The processor, by its model and the cores that this process may run on."""
    cores = usable_cores()
    return ", ".join([cpu_model(_read("/proc/cpuinfo")) or "unknown processor", *([f"{cores} cores"] if cores else [])])


def cpu_model(cpuinfo: str) -> str | None:
    """The processor's name in the text of /proc/cpuinfo; elsewhere what Python knows."""
    found = re.search(r"^(?:model name|Model|cpu model)\s*:\s*(.+)$", cpuinfo, re.MULTILINE)
    return " ".join(found[1].split()) if found else platform.processor() or None


def _read(path: str) -> str:
    try:
        return Path(path).read_text(errors="replace")
    except OSError:
        return ""


def mesa(gl_version: str) -> str | None:
    """'22.3.6' of '4.5 (Core Profile) Mesa 22.3.6'."""
    found = re.search(r"Mesa (\S+)", gl_version)
    return found[1] if found else None


def revision(folder: Path, run: Run = ask) -> dict[str, Any] | None:
    """The git commit of the package and whether files differ from it; None where it is not in a checkout."""
    found = run(["git", "-C", str(folder), "rev-parse", "--show-toplevel", "HEAD"])
    top, _, commit = (found or "").strip().partition("\n")
    if not commit or not (Path(top) / "pyproject.toml").is_file() or folder.parent.resolve() != Path(top).resolve():
        return None
    changed = run(["git", "-C", str(folder), "status", "--porcelain", "--untracked-files=no"])
    return {"commit": commit, "dirty": None if changed is None else bool(changed.strip())}


def nvidia(device: Mapping[str, str], run: Run = ask) -> dict[str, Any] | None:
    """Clocks, power, temperature and throttle reasons of the device's GPU, by nvidia-smi; None for other makers."""
    if "nvidia" not in (device.get("vendor") or "").lower():
        return None
    lines = (run(["nvidia-smi", f"--query-gpu={','.join(NVIDIA_FIELDS)}", "--format=csv,noheader,nounits"]) or "")
    gpus = [gpu for gpu in map(_gpu, lines.splitlines()) if gpu]
    return next((gpu for gpu in gpus if gpu["name"] and gpu["name"] in (device.get("renderer") or "")),
                gpus[0] if len(gpus) == 1 else None)


def _gpu(line: str) -> dict[str, Any] | None:
    values = [part.strip() for part in line.split(",")]
    if len(values) != len(NVIDIA_FIELDS):
        return None
    gpu = {name: _parsed(text, kind) for (name, kind), text in zip(NVIDIA_FIELDS.items(), values, strict=True)}
    gpu["throttle_reasons"] = throttle_reasons(gpu.pop("clocks_throttle_reasons.active"))
    return gpu


def _parsed(text: str, kind: type) -> Any:
    """A field of nvidia-smi; '[N/A]', '[Not Supported]' and the like are None."""
    if text.startswith("[") or text in ("", "N/A"):
        return None
    try:
        return kind(text)
    except ValueError:
        return None


def throttle_reasons(mask: str | None) -> list[str] | None:
    """The names of the bits of a hexadecimal mask."""
    try:
        bits = int(mask or "", 16)
    except ValueError:
        return None
    return [name for bit, name in THROTTLE_REASONS.items() if bits & bit]


def differences(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[str]:
    """'mesa: 22.3.6 -> 23.1.0' for every lasting entry in which two environments differ, and what held a GPU back."""
    first, second = (dict(_flat({n: v for n, v in tree.items() if n not in PASSING} | _held_back(tree)))
                     for tree in (before, after))
    return [f"{name}: {_said(first.get(name))} -> {_said(second.get(name))}"
            for name in dict.fromkeys([*first, *second]) if first.get(name) != second.get(name)]


def _held_back(tree: Mapping[str, Any]) -> dict[str, str]:
    """The reasons for lowered clocks of the GPU at either end of a run; empty if the driver does not report it."""
    ends = (_entry(_entry(tree, part), "gpu") for part in PASSING)
    reported = [reasons for gpu in ends if isinstance(reasons := gpu.get("throttle_reasons"), list)]
    causes = sorted({str(reason) for reasons in reported for reason in reasons} - {"idle"})
    return {"throttle reasons": ", ".join(causes) or "none"} if reported else {}


def _entry(tree: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    return found if isinstance(found := tree.get(name), Mapping) else {}


def _flat(tree: Mapping[str, Any], under: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in tree.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{under}{name}.")
        else:
            yield f"{under}{name}", value


def _said(value: Any) -> str:
    return "unknown" if value is None else str(value)
