"""Carries one run from its plans to its reports: what is kept and shared, what is measured, what is printed."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from .interruption import Interruption
from .output import note, say, say_lines, width
from .page_command import write_page_of
from .report_commands import hand_over, write_tables_of
from .time_budget import (
    MANY,
    end_s,
    left_out,
    left_out_in_all,
    left_out_line,
    refuse,
    refused_later,
    stop_at,
    time_left,
    within_reach,
)

# The parts of a manifest that are of the run that measured: one that finds everything measured leaves them alone.
OF_THE_MEASURING = ("started", "calibration", "versions", "environment", "calibration_end", "calibration_drift",
                    "split_s", "beside_s", "noise_floor_rel")


@dataclass(frozen=True)
class Choices:
    """The options of a run."""

    out: str | None
    force: bool
    keep_failed: bool
    try_hopeless: bool
    budget_s: float | None = None
    quiet: bool = False
    as_json: bool = False
    junit: str | None = None
    summary: str | None = None
    page: str | None = None
    drawn: bool = True  # figures, which of a share of a run would lack what the others measure
    settings: tuple[str, ...] = ()  # --set and --only as they were given, for the command that measures this again


def result_folders(plans, out: str | None, slug: str):
    """The result folder of each experiment."""
    from ..store import ResultFolder

    if out is None:
        return [ResultFolder(Path("results") / slug / e.name) for e, _ in plans]
    return [ResultFolder(Path(out) / e.name if len(plans) > 1 else out) for e, _ in plans]


def sources(plans, folders, choices: Choices):
    """The result folders next to those of a run, whose cells may be the same; none next to a DIR for one experiment."""
    from ..run.ledger import relatives

    beside = choices.out is None or len(plans) > 1
    return relatives(folders[0].path.parent if beside else None, folders)


def forecast_of(folders, ready):
    """The forecast for the device by the results of these folders."""
    from ..plan.forecast import Forecast, rates_of

    mine = [(folder.manifest(), [row for row in folder.cells() if _of_the_device(row, ready.device)])
            for folder in folders]
    return Forecast((row for _, rows in mine for row in rows), rates_of(mine, ready.calibration))


def _of_the_device(row: Mapping[str, Any], device: Mapping[str, str]) -> bool:
    made_by = row.get("device") or {}
    return all(made_by.get(name) == device[name] for name in ("renderer", "version"))


@dataclass
class Part:
    """One experiment of a run: its cells, and what its manifest says. figures: None as long as none are drawn."""

    experiment: Any
    sheet: Any
    manifest: dict[str, Any]
    figures: list[Path] | None = None

    @property
    def folder(self):
        return self.sheet.folder

    def write_manifest_at_start(self) -> None:
        self.manifest |= _of_the_measuring(self.folder.manifest(), self.manifest, all_kept=not self.sheet.pending)
        self.folder.write_manifest(self.manifest)


class Session:
    """All experiments of one command on one device. `table` gives the text of a folder that is printed."""

    def __init__(self, supervisor, interruption: Interruption, choices: Choices, started: float,
                 table: Callable[[Any, int], str] | None = None):
        self.table = table
        self.supervisor, self.interruption, self.choices, self.started = supervisor, interruption, choices, started
        from ..environment import slowness

        self.slowness = slowness()

    def run(self, plans) -> set[str]:
        """Measure, print and write the results; returns the statuses of all cells.

        Raises Interrupted or DeviceError where it has to end early, with what is kept.
        """
        from ..measure.split import Split
        from ..methods import catalog
        from ..run.jobs import hash_codes
        from ..run.ledger import Ledger

        codes: dict[Any, str] = {}
        for _, cells in plans:  # while the device is opened
            hash_codes(cells, catalog(), codes)
        ready = self.supervisor.ready()
        self.split = Split()
        self.split.seconds["start-up"] = time.perf_counter() - self.started
        folders = result_folders(plans, self.choices.out, ready.device["slug"])
        with self.split.work("plan"):
            parts = self._parts(plans, folders, ready, codes)
        with ExitStack() as stack:
            for part in parts:
                if unlocked := stack.enter_context(part.folder.lock()):
                    note(unlocked)
            with self.split.work("plan"):
                self.beside = sources(plans, folders, self.choices)
                self.ledger = Ledger([part.sheet for part in parts], ready.device, self.beside, split=self.split)
                stack.callback(self.ledger.close)
                self.ledger.settle(self.choices.force, self.choices.keep_failed, self.choices.try_hopeless)
                for part in parts:
                    part.write_manifest_at_start()
            self._measure(parts)
        return {status for part in parts for status in part.sheet.statuses.values()}

    def _parts(self, plans, folders, ready, codes: dict[Any, str]) -> list[Part]:
        """The experiments that have cells."""
        from ..methods import catalog
        from ..run.jobs import jobs
        from ..run.sheet import Sheet

        parts = []
        for (experiment, cells), folder in zip(plans, folders, strict=True):
            if cells:
                todo = jobs(cells, catalog(), ready.device, ready.timer, codes)
                made = manifest(experiment, todo, ready)
                made |= {"settings": list(self.choices.settings)} if self.choices.settings else {}
                parts.append(Part(experiment, Sheet(folder, todo), made))
        return parts

    def _measure(self, parts: Sequence[Part]) -> None:
        """Measure what is pending, then report each experiment."""
        from ..errors import DeviceError, Interrupted

        ledger, budget_s = self.ledger, self.choices.budget_s
        groups = ledger.groups(coarse_first=budget_s is not None)
        if budget_s is not None:
            refuse(parts, self.supervisor.ready().limits)
        deadlines = self._deadlines(groups, parts)
        measuring = [part for part in parts if part.sheet.pending]
        try:
            with self.interruption.in_its_time(), self._progress(groups, parts, deadlines[0]) as progress:
                ledger.report = progress.row
                self.supervisor.measure(groups, ledger, progress.saw, self.choices.try_hopeless, *deadlines, note)
            self._at_the_end(measuring)
            self._draw(parts)
            for part in parts:
                self._tell(part)
            if len(parts) > 1 and not self.choices.as_json:
                say_lines(left_out_in_all({part.experiment.name: part.sheet for part in parts}))
            folders = [part.folder for part in parts]
            if measuring and not (self.choices.as_json or self.choices.quiet):
                self._tell_split()
            hand_over(folders, self.choices.as_json, self.choices.junit, self.choices.summary)
            if self.choices.page:
                write_page_of(folders, self.choices.page, say if not self.choices.as_json else note)
        except KeyboardInterrupt:
            if self.interruption.asked():
                raise Interrupted(f"interrupted: {self._kept(parts)}; {_shown_by(parts)}") from None
            raise
        except DeviceError as error:
            for part in parts:
                self._report(part)
            raise DeviceError(f"{error}; {self._kept(parts)}") from None

    def _progress(self, groups, parts: Sequence[Part], until: float):
        """What tells of the cells while they are measured. until: as of `Progress`."""
        from .progress import Progress

        name = parts[0].experiment.name if len(parts) == 1 else f"{len(parts)} configs"
        return Progress(sum(map(len, groups)), name, self.interruption.asked, self.choices.quiet,
                        partial(self._foretold, groups, parts), until)

    def _deadlines(self, groups, parts: Sequence[Part]) -> tuple[float, float]:
        """The times of the monotonic clock at which to stop measuring, and to end the process that measures."""
        if self.choices.budget_s is None:
            return float("inf"), float("inf")
        stop = stop_at(self.choices.budget_s, self.started, groups, parts, self.choices.drawn,
                       self.supervisor.ready().calibrated_s, self.slowness)
        return time.monotonic() - time.perf_counter() + stop, float("inf")

    def _foretold(self, groups, parts: Sequence[Part]):
        """The time that the run will take, once what draws its figures is imported: the worker compiles meanwhile."""
        from ..report.figures import prepare_to_draw

        with self.interruption.at_once():
            if self.choices.drawn and any(part.experiment.figures for part in parts):
                prepare_to_draw()
            return self._time_left(groups, parts)

    def _time_left(self, groups, parts: Sequence[Part]):
        """The time that the run will take, by earlier results of the device."""
        ready, folders = self.supervisor.ready(), [part.folder for part in parts]
        if self.choices.budget_s is None:
            refuse(parts, ready.limits)
        reached = within_reach(groups, parts, self.choices.budget_s, self.slowness)
        return time_left(reached, forecast_of([*folders, *self.beside], ready), ready.limits.features,
                         self._ends_s(parts, {job.key for job in reached}), self.slowness)

    def _ends_s(self, parts: Sequence[Part], keys: AbstractSet[str]) -> float:
        """Seconds that should follow the last of the cells of these keys."""
        return end_s(parts, keys, self.choices.drawn, self.supervisor.ready().calibrated_s, self.slowness)

    def _at_the_end(self, parts: Sequence[Part]) -> None:
        """The state to compare with the start of the run: the timer and the device's speed, load and clocks.

        Raises StoreError where rows that were written are gone.
        """
        from ..environment import passing
        from ..measure.calibration import disagreement

        with self.split.work("calibration"):
            again = self.supervisor.calibrate_again() if parts else None
        for part in parts:
            part.sheet.refuse_gone()
            part.manifest["environment"]["end"] = passing(part.manifest["device"])
            if again:
                part.manifest["calibration_end"] = dict(again)
                part.manifest["calibration_drift"] = disagreement(part.manifest["calibration"], again)

    def _tell_split(self) -> None:
        """Print what the time went into."""
        from ..measure.split import told

        say_lines(told(self._spent()["split_s"]))

    def _tell(self, part: Part) -> None:
        """Print an experiment's tables, write what is derived from its cells, say how it ended."""
        from ..report import terminal_table

        part.manifest |= {"left_out": left_out(part.sheet), "refused": refused_later(part.sheet)}
        self._write_what_is_known(part)
        if not self.choices.as_json:
            say((self.table or terminal_table)(part.folder, width()))
        written = self._report(part)
        if not self.choices.as_json:
            say_lines(summary(part.sheet, part.manifest, written))

    def _draw(self, parts: Sequence[Part]) -> None:
        """Draw the figures of many experiments side by side; those of few are drawn as each is told of."""
        from ..report import write_all

        if not self.choices.drawn or len(parts) < MANY:
            return
        for part in parts:
            self._write_what_is_known(part)
        with self.split.work("report"):
            for part, drawn in zip(parts, write_all([part.folder for part in parts]), strict=True):
                part.figures = drawn.paths
                for line in drawn.empty:
                    note(line)

    def _report(self, part: Part) -> list[Path]:
        from ..report import write_figures

        self._write_what_is_known(part)
        with self.split.work("report"):
            written = write_tables_of(part.folder)
            if self.choices.drawn:
                written += part.figures if part.figures is not None else write_figures(part.folder)
        part.folder.write_manifest(self._spent() | part.manifest)
        return written

    @staticmethod
    def _write_what_is_known(part: Part) -> None:
        """Let the manifest have what tables and figures tell: the noise floor, whether the machine was steady."""
        if part.sheet.noise_floor_rel is not None:
            part.manifest["noise_floor_rel"] = part.sheet.noise_floor_rel
        part.folder.write_manifest(part.manifest)

    def _spent(self) -> dict[str, dict[str, float]]:
        """Tells where the time of the command went until now, and what the process beside the device did meanwhile."""
        beside_s = {kind: round(seconds, 3) for kind, seconds in self.ledger.beside_s.items()}
        return {"split_s": self.split.whole(time.perf_counter() - self.started), "beside_s": beside_s}

    @staticmethod
    def _kept(parts: Sequence[Part]) -> str:
        """How many cells there are so far, and where."""
        kept = sum(part.sheet.rows(key) for part in parts for key in part.sheet.jobs if part.folder.has(key))
        total = sum(part.sheet.total for part in parts)
        return f"{kept} of {total} cells are kept in {_place(parts)}; the same command measures the others"


def _place(parts: Sequence[Part]) -> Path:
    """The folder that has the results of all parts at or below it."""
    return parts[0].folder.path.parent if parts[1:] else parts[0].folder.path


def _shown_by(parts: Sequence[Part]) -> str:
    """The command that shows what is kept of a run that was to end at once."""
    return f"mfr-bench table {_place(parts)} shows what is there"


def _of_the_measuring(before: Mapping[str, Any], now: Mapping[str, Any], all_kept: bool) -> dict[str, Any]:
    """The parts that a new manifest takes over from the one before it."""
    same_place = all(before.get(name) == now[name] for name in ("device", "timer"))
    names = OF_THE_MEASURING if all_kept else ("noise_floor_rel",) if same_place else ()
    return {name: before[name] for name in names if name in before}


def summary(sheet, manifest: Mapping[str, Any], written: Sequence[Path]) -> str:
    """The lines that say how an experiment ended and where its results are."""
    from ..report.tables import noise_text

    statuses = ", ".join(f"{count} {status}" for status, count in sorted(sheet.counts.items(), key=_ok_first))
    kept = f"; {sheet.kept} kept from before, --force measures them again" if sheet.kept else ""
    copied = f"; {sheet.copied} copied from other results, where they are the same" if sheet.copied else ""
    noise = manifest.get("noise_floor_rel")
    total = sheet.counts.total()
    cells = "1 cell" if total == 1 else f"{total} cells"
    lines = [f"{cells}: {statuses}{kept}{copied}" if total else "no cell is measured"]
    lines += filter(None, [left_out_line(sheet)])
    if noise is not None:
        lines.append(f"noise floor {noise_text(noise)}: the same method measured twice differs by that"
                     + "; measure again by --force while the machine does nothing else" * (noise > 1))
    for title, suffix in (("tables", ".md"), ("figures", ".png")):
        paths = [str(path) for path in written if path.suffix == suffix]
        lines += [f"{title if number == 0 else '':8}{path}" for number, path in enumerate(paths)]
    return "\n".join(lines)


def _ok_first(entry: tuple[str, int]) -> tuple[bool, str]:
    return entry[0] != "ok", entry[0]


def _packages(todo) -> dict[str, Any]:
    """The packages that bring methods, effects and scenes from outside, if there are any."""
    from ..store.record import PACKAGES

    found = {package["name"]: dict(package) for job in todo for part in PACKAGES if (package := getattr(job, part))}
    return {"packages": list(found.values())} if found else {}


def manifest(experiment, todo, ready) -> dict[str, Any]:
    """The manifest of a result folder: its experiment, device and run."""
    from .. import environment
    from ..scene.spec.values import told

    places: dict[str, int] = {}
    for job in todo:
        places.setdefault(job.key, job.cell.place)
    return {
        "name": experiment.name, "title": experiment.title, "source": dict(experiment.source),
        "config": experiment.path.name, "scene": experiment.scene.as_dict(), "params": dict(experiment.params),
        "profile": experiment.profile,
        "sweep": {name: [told(value) for value in values] for name, values in experiment.sweep.items()},
        "zip": {name: [told(value) for value in values] for name, values in experiment.zip.items()},
        "methods": [{"id": m.id, "label": m.label, "params": dict(m.params)} for m in experiment.methods],
        "measure": experiment.measure.as_dict(), "figures": [f.as_dict() for f in experiment.figures],
        "cells": list(places), "places": list(places.values()), "device": dict(ready.device),
        **_packages(todo), "timer": ready.timer, "calibration": dict(ready.calibration),
        "versions": environment.versions(),
        "environment": environment.at_the_start(ready.device) | {"bound_threads": ready.bound_threads,
                                                                 "instructions": ready.instructions},
        "started": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
    }
