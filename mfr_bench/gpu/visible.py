"""The GPUs that a scheduler or a user has given to this process: CUDA_VISIBLE_DEVICES, and Slurm's GRES.

EGL numbers devices otherwise than CUDA and Slurm do, and lists those of others too. They are matched by UUID, by PCI
address, or by the CUDA number that EGL_NV_device_cuda tells; where a driver tells none of these, nothing is guessed.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from pathlib import Path

CUDA, SLURM = "CUDA_VISIBLE_DEVICES", ("SLURM_STEP_GPUS", "SLURM_JOB_GPUS")
NVIDIA = Path("/proc/driver/nvidia/gpus")  # a folder for each GPU, by its PCI address
MINOR = re.compile(r"^Device Minor:\s*(\d+)", re.MULTILINE)
UUID = re.compile(r"gpu-([0-9a-f][0-9a-f-]*)")
NUMBER = re.compile(r"\+?(\d+)")  # also with something after it
RANGE = re.compile(r"(\d+)(?:-(\d+))?")


@dataclass(frozen=True)
class Visible:
    """The GPUs that the process was given: UUIDs or their beginnings, PCI addresses, CUDA numbers.

    said: the variable with its value. nothing: no GPU is given. parts: a part of a GPU (MIG) is, which has no OpenGL of
    its own.
    """

    said: str
    uuids: tuple[str, ...] = ()
    pcis: tuple[str, ...] = ()
    numbers: tuple[int, ...] = ()
    nothing: bool = False
    parts: bool = False

    def admits(self, uuid: str | None, pci: str | None, number: int | None) -> bool | None:
        """Whether a GPU is one of those; None where what is known of it does not tell.

        uuid, pci, number: as EGL or GL have them; the last is the CUDA number.
        """
        if self.nothing or self.parts:
            return False
        known = [uuid.startswith(self.uuids) for _ in self.uuids[:1] if uuid]
        known += [pci in self.pcis for _ in self.pcis[:1] if pci]
        known += [number in self.numbers for _ in self.numbers[:1] if number is not None and not known]
        return any(known) if known else None


def visible(environ: Mapping[str, str] | None = None, nvidia: Path = NVIDIA) -> Visible | None:
    """The GPUs that the environment gives this process; None where it says nothing."""
    found = os.environ if environ is None else environ
    given = _cuda(found[CUDA]) if CUDA in found else None
    if given and not given.numbers:
        return given
    numbers, addresses = given.numbers if given else (), _addresses(nvidia)
    for variable in SLURM:  # numbers of device files, whatever a job sees of them
        if minors := _numbers(found.get(variable, "")):
            said = f"{variable}={found[variable]}" + (f", {given.said}" if given else "")
            return Visible(said, pcis=_of_job(minors, numbers, addresses), numbers=numbers)
    if not given:
        return None
    ordered = sorted(addresses.values())
    by_bus = found.get("CUDA_DEVICE_ORDER") == "PCI_BUS_ID"
    return replace(given, pcis=tuple(ordered[n] for n in numbers if by_bus and n < len(ordered)))


def _cuda(value: str) -> Visible:
    """The GPUs that a value of CUDA_VISIBLE_DEVICES gives, as CUDA reads it.

    Its first entry decides whether it is of UUIDs or of numbers; the list ends at the first entry that is none, such as
    -1, and gives nothing if an entry stands twice.
    """
    said, names = f"{CUDA}={value}", [name.strip().lower() for name in value.split(",")]
    if names[0].startswith("mig-"):
        return Visible(said, parts=True)
    pattern = UUID if names[0].startswith("gpu-") else NUMBER
    matches = takewhile(bool, map(pattern.fullmatch if pattern is UUID else pattern.match, names))
    entries = [match[1] if pattern is UUID else int(match[1]) for match in matches]
    if not entries or len({*entries}) < len(entries):
        return Visible(said, nothing=True)
    return replace(Visible(said), **{"uuids" if pattern is UUID else "numbers": tuple(entries)})


def _of_job(minors: Sequence[int], numbers: Sequence[int], addresses: Mapping[int, str]) -> tuple[str, ...]:
    """PCI addresses of a job's GPUs, of those that CUDA_VISIBLE_DEVICES leaves if it has fewer numbers.

    Where Slurm shuts the other GPUs off, a job counts its own from 0, and otherwise all of the node: none where both
    readings are possible and differ.
    """
    job = [addresses[minor] for minor in minors if minor in addresses]
    if not numbers or len(numbers) >= len(job):
        return tuple(job)
    own = [sorted(job)[n] for n in numbers if n < len(job)]
    named = [addresses[n] for n in numbers if n in minors and n in addresses]
    readings = {frozenset(reading) for reading in (own, named) if len(reading) == len(numbers)}
    return tuple(sorted(readings.pop())) if len(readings) == 1 else ()


def _numbers(text: str) -> list[int]:
    """The numbers of '0,2-3'; none where it is no such list."""
    found = [RANGE.fullmatch(part.strip()) for part in text.split(",")]
    return [n for match in found for n in range(int(match[1]), int(match[2] or match[1]) + 1)] if all(found) else []


def _addresses(nvidia: Path) -> dict[int, str]:
    """PCI addresses of NVIDIA's GPUs by the number of the device file, /dev/nvidia<N>."""
    found = {}
    for path in sorted(nvidia.glob("*/information")):
        try:
            minor = MINOR.search(path.read_text(errors="replace"))
        except OSError:
            continue
        if minor:
            found[int(minor[1])] = path.parent.name.lower()
    return found
