"""`run`: measure what is missing, then write tables and figures."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from .interruption import Interruption
from .options import DEVICE, PROFILE, SET, ConfigName, MethodName, OutPath
from .output import note, say, width
from .report_commands import write_report

WRONG, FAILED = 3, 1

# What a manifest tells of the run that measured: a run that finds everything measured leaves it alone.
OF_THE_MEASURING = ("started", "calibration", "versions", "split_s", "noise_floor_rel")


@click.command()
@click.argument("configs", nargs=-1, required=True, metavar="CONFIG...", type=ConfigName())
@click.option("--out", metavar="DIR", type=OutPath(file_okay=False),
              help="Where results go; with several configs DIR/<name>/ each. "
                   "[default: results/<device>/<config name>]")
@PROFILE
@click.option("--only", metavar="METHOD,...", type=MethodName(), help="Only these methods, by id.")
@SET
@DEVICE
@click.option("--force", is_flag=True, help="Measure cells again that the folder already has.")
@click.option("--dry-run", is_flag=True, help="Print the plan: what would be measured, what skipped, and why.")
def run(configs: tuple[str, ...], out: str | None, profile: str | None, only: str | None,
        overrides: tuple[str, ...], device: str, force: bool, dry_run: bool) -> int:
    """Measure what the results lack, then write tables and figures.

    CONFIG is a file, a folder of files, or the name of a shipped config (see mfr-bench configs).

    \b
    Examples:
      mfr-bench run smoke
      mfr-bench run kplus2015-fig6 --profile smoke --out /tmp/fig6
      mfr-bench run smoke --only kplus-array,kplus-heap --set k=32
      mfr-bench run smoke --set scene.order=back_to_front --force
    """
    started = time.perf_counter()
    plans = _plans(configs, profile, only, overrides)
    with Interruption() as interruption:
        if dry_run:
            _print_plans(plans, out, device)
            return 0
        statuses = _run_plans(plans, out, device, force, interruption, started)
    if "wrong" in statuses:
        return WRONG
    return FAILED if statuses & {"crashed", "timeout", "out_of_memory", "overflow"} else 0


def _run_plans(plans, out: str | None, want: str, force: bool, interruption: Interruption, started: float) -> set[str]:
    """Measure every plan on one device; returns the statuses of all cells."""
    from ..gpu.device import open_device
    from ..gpu.selftest import calibrate, timer_for

    opened = open_device(want)
    calibration = calibrate(opened)
    session = Session(opened, timer_for(opened, calibration), calibration, force, interruption,
                      time.perf_counter() - started)
    folders = _folders(plans, out, opened.info["slug"])
    statuses: set[str] = set()
    for (experiment, cells), folder in zip(plans, folders, strict=True):
        statuses |= session.run(experiment, cells, folder) if cells else set()
    return statuses


def _plans(configs: Sequence[str], profile: str | None, only: str | None, overrides: Sequence[str]):
    """Every experiment with its cells; without cells where --only leaves none of them, but of another's.

    Raises UsageError with the mistakes of all configs at once.
    """
    from ..errors import UsageError
    from ..methods import catalog
    from ..plan import expand

    experiments = _experiments(configs, profile, overrides)
    chosen = None if only is None else [name.strip() for name in only.split(",")]
    plans = [(e, expand(e, catalog(), chosen)) for e in experiments]
    if not any(cells for _, cells in plans):
        raise UsageError(f"{e.name}: --only {only} leaves no cell; allowed: "
                         f"{', '.join(dict.fromkeys(m.id for m in e.methods))}" for e, _ in plans)
    return plans


def _experiments(configs: Sequence[str], profile: str | None, overrides: Sequence[str]):
    """The experiments of all references, each file once. Raises UsageError with all mistakes, equal names included."""
    from ..config import load
    from ..errors import UsageError
    from ..methods import catalog

    found: dict[Path, Any] = {}
    mistakes: dict[str, None] = {}
    for reference in configs:
        try:
            found.update((Path(e.path).resolve(), e) for e in load(reference, catalog(), profile, overrides))
        except UsageError as error:
            mistakes.update(dict.fromkeys(error.lines))
    named: dict[str, Any] = {}
    for experiment in found.values():
        if named.setdefault(experiment.name, experiment) is not experiment:
            mistakes[f"{experiment.path}: name: {experiment.name!r} is also the name in "
                     f"{named[experiment.name].path}; allowed: a name of its own"] = None
    if mistakes:
        raise UsageError(mistakes)
    return list(found.values())


def _folders(plans, out: str | None, slug: str):
    """The result folder of each experiment."""
    from ..store import ResultFolder

    if out is None:
        return [ResultFolder(Path("results") / slug / e.name) for e, _ in plans]
    return [ResultFolder(Path(out) / e.name if len(plans) > 1 else out) for e, _ in plans]


def _print_plans(plans, out: str | None, want: str) -> None:
    from ..errors import DeviceError
    from ..methods import catalog
    from ..plan import overview

    try:
        from ..gpu.device import open_device

        opened = open_device(want)
    except DeviceError as error:
        opened = None
        note(f"{error}; the plan below holds only the budget against the cells")
    folders = _folders(plans, out, opened.info["slug"] if opened else "unknown-device")
    for (experiment, cells), folder in zip(plans, folders, strict=True):
        if not cells:
            continue
        rows = overview(cells, catalog(), opened.limits if opened else None)
        kept = _kept(cells, folder, opened) if opened else set()
        for number, row in enumerate(rows):
            if number in kept and row["decision"] == "measure":
                row["decision"] = "kept: already measured"
        say(_plan_text(experiment, rows, folder))


def _kept(cells, folder, opened) -> set[int]:
    """Which cells the folder already has. Costs a calibration only where there is something to keep."""
    if not folder.cells_path.is_dir():
        return set()
    from ..gpu.selftest import calibrate
    from ..methods import catalog
    from ..runner import jobs

    todo = jobs(cells, catalog(), opened.info, calibrate(opened).timer)
    return {number for number, job in enumerate(todo) if folder.has(job.key)}


def _plan_text(experiment, rows: list[dict[str, Any]], folder) -> str:
    lines = [f"{experiment.name}: {experiment.title}", f"  {len(rows)} cells -> {folder.path}"]
    label = max(len(r["label"]) for r in rows)
    where = [" ".join(f"{k.removeprefix('scene.')}={v}" for k, v in r["point"].items()) for r in rows]
    place = max(map(len, where))
    lines += [f"  {r['label']:{label}}  {w:{place}}  {r['memory_bytes'] / 2**20:10,.2f} MiB  {r['decision']}"
              for r, w in zip(rows, where, strict=True)]
    measured = sum(r["decision"] == "measure" for r in rows)
    return "\n".join([*lines, f"  {measured} to measure, {len(rows) - measured} not"])


class Session:
    """One device and timer, for all configs of a command."""

    def __init__(self, device, timer, calibration, force: bool, interruption: Interruption, startup_s: float):
        self.device, self.timer, self.calibration, self.force = device, timer, calibration, force
        self.interruption, self.startup_s = interruption, startup_s

    def run(self, experiment, cells, folder) -> set[str]:
        """Measure one experiment, print and write its results; returns the statuses of its cells."""
        from ..errors import Interrupted
        from ..measure.split import Split
        from ..methods import catalog
        from ..report import terminal_table
        from ..runner import Runner, jobs
        from .progress import Progress

        split = Split()
        split.seconds["start-up"], self.startup_s = self.startup_s, 0.0
        todo = jobs(cells, catalog(), self.device.info, self.timer.name)
        missing = sum(1 for job in todo if self.force or not folder.has(job.key))
        manifest = self._manifest(experiment, todo)
        manifest |= _of_the_measuring(folder.manifest(), manifest, all_kept=not missing)
        folder.write_manifest(manifest)
        asked = self.interruption.asked
        with Progress(missing, experiment.name, asked) as progress:
            runner = Runner(self.device, self.timer, folder, catalog(), progress.row, progress.sampled, split, asked)
            finished = _until_interrupted(lambda: runner.run(todo, self.force))
        if runner.summary.noise_floor_rel is not None:
            manifest["noise_floor_rel"] = runner.summary.noise_floor_rel
            folder.write_manifest(manifest)
        if finished:
            say(terminal_table(folder, width()))
        with split.work("report"):
            written = write_report(folder)
        folder.write_manifest({"split_s": split.rounded()} | manifest)
        if not finished:
            kept = sum(1 for job in todo if folder.has(job.key))
            raise Interrupted(f"interrupted: {kept} of {len(todo)} cells are kept in {folder.path}; "
                              "the same command measures the others")
        say(_summary(runner.summary, manifest, written))
        return set(runner.summary.statuses)

    def _manifest(self, experiment, todo) -> dict[str, Any]:
        from dataclasses import asdict

        return {
            "name": experiment.name, "title": experiment.title, "source": dict(experiment.source),
            "config": str(experiment.path), "scene": experiment.scene.as_dict(), "params": dict(experiment.params),
            "sweep": {name: list(values) for name, values in experiment.sweep.items()},
            "zip": {name: list(values) for name, values in experiment.zip.items()},
            "measure": experiment.measure.as_dict(), "figures": [f.as_dict() for f in experiment.figures],
            "cells": list(dict.fromkeys(job.key for job in todo)), "device": dict(self.device.info),
            "timer": self.timer.name, "calibration": asdict(self.calibration), "versions": _versions(),
            "started": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        }


def _until_interrupted(work: Callable[[], object]) -> bool:
    """Whether the work came to its end, and not to Ctrl-C."""
    try:
        work()
    except KeyboardInterrupt:
        return False
    return True


def _of_the_measuring(before: Mapping[str, Any], now: Mapping[str, Any], all_kept: bool) -> dict[str, Any]:
    """What a new manifest takes over from the one before it."""
    same_place = all(before.get(name) == now[name] for name in ("device", "timer"))
    names = OF_THE_MEASURING if all_kept else ("noise_floor_rel",) if same_place else ()
    return {name: before[name] for name in names if name in before}


def _summary(summary, manifest: Mapping[str, Any], written: Sequence[Path]) -> str:
    """How the run ended, and where its results are."""
    statuses = ", ".join(f"{count} {status}" for status, count in sorted(summary.statuses.items(), key=_ok_first))
    kept = f"; {summary.kept} kept from before, --force measures them again" if summary.kept else ""
    noise = manifest.get("noise_floor_rel")
    lines = [f"{sum(summary.statuses.values())} cells: {statuses}{kept}"]
    if noise is not None:
        lines.append(f"noise floor {100 * noise:.2g} %: the same method measured twice differs by that")
    for title, suffix in (("tables", ".md"), ("figures", ".png")):
        paths = [str(path) for path in written if path.suffix == suffix]
        lines += [f"{title if number == 0 else '':8}{path}" for number, path in enumerate(paths)]
    return "\n".join(lines)


def _ok_first(entry: tuple[str, int]) -> tuple[bool, str]:
    return entry[0] != "ok", entry[0]


def _versions() -> dict[str, str]:
    import platform
    from importlib.metadata import version

    from .. import __version__

    packages = ("moderngl", "glcontext", "numpy", "flip-evaluator")
    return {"mfr-bench": __version__, "python": platform.python_version(), "system": platform.platform(),
            **{name: version(name) for name in packages}}


COMMANDS = (run,)
