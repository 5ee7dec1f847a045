"""Results for other programs: JSON of every row, and JUnit XML as the gates of hosted CI read it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal
from xml.etree import ElementTree as ET

from ..store import ResultFolder
from ..store.record import plain
from .data import Result, heading, load

Outcome = Literal["passed", "failure", "error", "skipped"]
ABOUT = ("title", "source", "profile", "device", "timer", "versions", "packages", "started", "noise_floor_rel",
         "calibration_drift")


def record(folder: ResultFolder) -> dict[str, Any]:
    """A result as JSON values: what its manifest says of it, and a row of results.csv for each cell."""
    result = load(folder)
    return plain({"name": result.name, **{name: result.manifest[name] for name in ABOUT if name in result.manifest},
                  "unmeasured": result.unmeasured, "cells": [dict(point.row) for point in result.points]})


@dataclass(frozen=True)
class Case:
    """A test case of a JUnit report: a cell, how it ended, and why. `seconds`: what it measured."""

    suite: str
    name: str
    outcome: Outcome = "passed"
    message: str = ""
    seconds: float = 0.0


def cases(results: Iterable[Result]) -> list[Case]:
    """The cells of results: a wrong image is a failure, a cell that ended badly an error, a refused one skipped."""
    return [case for result in results for case in _of_result(result)]


def _of_result(result: Result) -> list[Case]:
    found = []
    for point in result.points:
        ending, places = point.ending, [heading(a, point.at(a), " ") for a in result.axes if point.at(a) is not None]
        outcome = ("passed" if point.status == "ok" else "skipped" if not ending.failed
                   else "failure" if ending.timed else "error")
        seconds = (point.row["time_ms"] or 0.0) / 1e3
        message = f"{point.sign}: {point.cell.get('reason') or ''}".rstrip(": ")
        found.append(Case(result.name, ", ".join([point.label, *places]), outcome, message, seconds))
    if result.unmeasured:
        found.append(Case(result.name, "planned cells without a record", "error", f"{result.unmeasured} cells"))
    return found


def junit(found: Sequence[Case]) -> bytes:
    """The report as XML: a suite for each experiment. The form is that of Ant's and Maven's reports.

    The standard library writes it; junitparser and junit-xml, which were looked at, do no more for so flat a form.
    """
    root = ET.Element("testsuites", _counts(found) | {"name": "mfr-bench"})
    for name in dict.fromkeys(case.suite for case in found):
        mine = [case for case in found if case.suite == name]
        suite = ET.SubElement(root, "testsuite", {"name": name} | _counts(mine))
        for case in mine:
            _write(suite, case)
    ET.indent(root)
    return ET.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"


def _counts(found: Sequence[Case]) -> Mapping[str, str]:
    outcomes = [case.outcome for case in found]
    return {"tests": str(len(found)), "failures": str(outcomes.count("failure")),
            "errors": str(outcomes.count("error")), "skipped": str(outcomes.count("skipped")),
            "time": f"{sum(case.seconds for case in found):.6f}"}


def _write(suite: ET.Element, case: Case) -> None:
    made = ET.SubElement(suite, "testcase", {"classname": case.suite, "name": case.name,
                                                      "time": f"{case.seconds:.6f}"})
    if case.outcome != "passed":
        child = ET.SubElement(made, case.outcome, {"message": case.message})
        child.text = case.message
