"""Keeps Mesa's software drivers from the vector registers for which their compiler makes wrong programs.

LLVM 21 loads the constant -1 by an instruction that reaches the first 16 vector registers, and yet may give it one of
the 16 that AVX-512 adds. The instruction then changes another register, so that sums and comparisons go wrong, or loops
never end, in programs that keep many values at once. Mesa's variable GALLIUM_OVERRIDE_CPU_CAPS names the newest
instruction set that it may use; `avx` is the newest that it knows the name of, and without those registers.
"""

from __future__ import annotations

import mmap
import os
import re
from functools import cache
from pathlib import Path

VARIABLE, WITHOUT = "GALLIUM_OVERRIDE_CPU_CAPS", "avx"
CPUINFO = Path("/proc/cpuinfo")
REGISTERS = re.compile(r"^flags\s*:.*\bavx512vl\b", re.MULTILINE)  # 32 registers of each width
LIBRARIES = Path("/usr")
DRIVERS = tuple(f"{folder}/{name}" for folder in ("lib/*-linux-gnu", "lib64", "lib")
                for name in ("libgallium-*.so", "libvulkan_lvp.so", "dri/swrast_dri.so"))
COMPILER = re.compile(rb"libLLVM(?:\.so\.|-)21\b")  # what a driver that uses LLVM 21 is linked with


def avoid_high_registers() -> None:
    """Set Mesa's variable for this process and those that it starts, where it is needed; before a driver is loaded.

    A value that the user has given stays.
    """
    if VARIABLE not in os.environ and _is_hit():
        os.environ[VARIABLE] = WITHOUT


def instructions() -> str | None:
    """The newest instruction set that Mesa's software drivers may use; None: the processor's."""
    return os.environ.get(VARIABLE)


@cache
def _is_hit() -> bool:
    """Whether the processor has the registers and a driver of the system the compiler."""
    try:
        return bool(REGISTERS.search(CPUINFO.read_text(errors="replace"))) and any(map(_has_compiler, _drivers()))
    except (OSError, ValueError):  # ValueError: an empty file cannot be mapped
        return False


def _drivers() -> list[Path]:
    """The files of Mesa's software drivers where distributions put them, each once."""
    return sorted({path.resolve() for pattern in DRIVERS for path in LIBRARIES.glob(pattern)})


def _has_compiler(driver: Path) -> bool:
    with driver.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as held:
        return COMPILER.search(held) is not None
