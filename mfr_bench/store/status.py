"""The statuses of a cell, and everything that the program decides by them.

A new status is one entry of `STATUSES`: tables, figures, claims, comparisons and exit statuses read its fields.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

EXACT_ERROR = 1e-4  # largest channel error of an exact image: rounding of float32 payload math, n <= 1024

Image = Literal["right", "wrong", "none"]
Break = Literal["", "crashed", "hung", "refused"]


@dataclass(frozen=True)
class Status:
    """One way in which a planned cell ends.

    image: whether the cell was measured to its end (it has a time then), and with which image.
    refused: the device or the budget forbids the cell, so that it says nothing against its method.
    retried: the next run measures the cell again, because the cause may have gone.
    failed: the cell is a failure of its method or of the run; `compare` counts it as worse than none.
    over_memory: the cell needs more memory than there is; line charts draw a cross on the axis.
    exit_status: what a run that has such a cell ends with; of several statuses the highest number counts.
    breaks: the fault that a figure of kind `breaking` draws; empty where the image and the counts decide.
    """

    name: str
    meaning: str
    image: Image = "none"
    refused: bool = False
    retried: bool = False
    failed: bool = False
    over_memory: bool = False
    exit_status: int = 0
    breaks: Break = "refused"
    words: str = ""  # in tables and figures, unless the name itself serves

    @property
    def timed(self) -> bool:
        """Whether such a cell has a time."""
        return self.image != "none"

    @property
    def sign(self) -> str:
        """The status as tables and figures print it."""
        return self.words or self.name.replace("_", " ")


STATUSES = {status.name: status for status in (
    Status("ok", "measured; an exact method's image is the promised one", image="right", breaks=""),
    Status("wrong", "measured, but an exact method's image is not the promised one, or differs from frame to frame",
           image="wrong", failed=True, exit_status=3, breaks="", words="wrong image"),
    Status("unsupported", "the device lacks a feature that the method needs, or fails a self-test that all need",
           refused=True),
    Status("over_budget", "the cell needs more memory, or a larger object, than the budget or the device allows",
           refused=True, over_memory=True),
    Status("overflow", "the scene has more fragments than the method could allocate room for",
           failed=True, over_memory=True),
    Status("timeout", "the cell took, or by smaller cells would take, longer than it may",
           retried=True, failed=True, exit_status=1, breaks="hung"),
    Status("crashed", "the driver or the method raised an error, or the measuring process died",
           retried=True, failed=True, exit_status=1, breaks="crashed"),
    Status("out_of_memory", "the machine or the device had no memory left",
           retried=True, failed=True, over_memory=True, exit_status=1, breaks="crashed"),
)}
