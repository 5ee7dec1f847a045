"""`run`: measure what is missing, then write tables and figures."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from .options import DEVICE, PROFILE, SET, ConfigName, MethodName
from .report_commands import write_report

WRONG, FAILED = 3, 1


@click.command()
@click.argument("configs", nargs=-1, required=True, metavar="CONFIG...", type=ConfigName())
@click.option("--out", metavar="DIR", type=click.Path(file_okay=False),
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
    """Measure every cell of CONFIG that is not yet in the results, then write tables and figures.

    CONFIG is a file, a folder of files, or the name of a shipped config (see mfr-bench configs).

    \b
    Examples:
      mfr-bench run smoke
      mfr-bench run kplus2015-fig6 --profile smoke --out /tmp/fig6
      mfr-bench run smoke --only kplus-array,kplus-heap --set k=32 --set scene.order=back_to_front
    """
    started = time.perf_counter()
    plans = _plans(configs, profile, only, overrides)
    if dry_run:
        _print_plans(plans, out, device)
        return 0

    from ..gpu.device import open_device
    from ..gpu.selftest import calibrate, timer_for

    opened = open_device(device)
    calibration = calibrate(opened)
    session = Session(opened, timer_for(opened, calibration), calibration, force, time.perf_counter() - started)
    folders = _folders(plans, out, opened.info["slug"])
    statuses: set[str] = set()
    for (experiment, cells), folder in zip(plans, folders, strict=True):
        statuses |= session.run(experiment, cells, folder)
    if "wrong" in statuses:
        return WRONG
    return FAILED if statuses & {"crashed", "timeout", "out_of_memory", "overflow"} else 0


def _plans(configs: Sequence[str], profile: str | None, only: str | None, overrides: Sequence[str]):
    """Every experiment with its cells. Raises UsageError with the mistakes of all configs at once."""
    from ..config import load
    from ..errors import UsageError
    from ..methods import catalog
    from ..plan import expand

    experiments, mistakes = [], []
    for reference in configs:
        try:
            experiments += load(reference, catalog(), profile, overrides)
        except UsageError as error:
            mistakes += [line for line in error.lines if line not in mistakes]
    if mistakes:
        raise UsageError(mistakes)
    chosen = only.split(",") if only else None
    plans = [(e, expand(e, catalog(), chosen)) for e in experiments]
    empty = [f"{e.name}: --only {only} leaves no cell; the config has {', '.join(dict.fromkeys(m.id for m in e.methods))}"
             for e, cells in plans if not cells]
    if len(empty) == len(plans):
        raise UsageError(empty)
    return [plan for plan in plans if plan[1]]


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
        click.echo(f"{error}; the plan below holds only the budget against the cells", err=True)
    folders = _folders(plans, out, opened.info["slug"] if opened else "unknown-device")
    for (experiment, cells), folder in zip(plans, folders, strict=True):
        rows = overview(cells, catalog(), opened.limits if opened else None)
        kept = _kept(cells, folder, opened) if opened else set()
        for number, row in enumerate(rows):
            if number in kept and row["decision"] == "measure":
                row["decision"] = "kept: already measured"
        click.echo(_plan_text(experiment, rows, folder))


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
    lines += [f"  {r['label']:{label}}  {w:{place}}  {r['memory_bytes'] / 2**20:9.1f} MiB  {r['decision']}"
              for r, w in zip(rows, where, strict=True)]
    measured = sum(r["decision"] == "measure" for r in rows)
    return "\n".join([*lines, f"  {measured} to measure, {len(rows) - measured} not"])


class Session:
    """One device and timer, for all configs of a command."""

    def __init__(self, device, timer, calibration, force: bool, startup_s: float):
        self.device, self.timer, self.calibration, self.force = device, timer, calibration, force
        self.startup_s = startup_s

    def run(self, experiment, cells, folder) -> set[str]:
        """Measure one experiment, write and print its results; returns the statuses of its cells."""
        from ..measure.split import Split
        from ..methods import catalog
        from ..report import terminal_table
        from ..runner import Runner, jobs
        from .progress import Progress

        split = Split()
        split.seconds["start-up"], self.startup_s = self.startup_s, 0.0
        todo = jobs(cells, catalog(), self.device.info, self.timer.name)
        manifest = self._manifest(experiment, todo)
        folder.write_manifest(manifest)
        missing = sum(1 for job in todo if self.force or not folder.has(job.key))
        with Progress(missing, experiment.name) as progress:
            runner = Runner(self.device, self.timer, folder, catalog(), progress.row, split)
            try:
                summary = runner.run(todo, self.force)
            finally:
                written = self._close(folder, manifest, runner, split)
        click.echo(terminal_table(folder))
        click.echo("\n".join(str(path) for path in written if path.suffix in (".png", ".md")))
        return set(summary.statuses)

    def _close(self, folder, manifest, runner, split) -> list[Path]:
        """Tables and figures of what there is, also after an interruption; then the manifest with the split."""
        with split.work("report"):
            written = write_report(folder)
        noise = runner.summary.noise_floor_rel
        folder.write_manifest(manifest | {"split_s": split.rounded()}
                              | ({"noise_floor_rel": noise} if noise is not None else {}))
        return written

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


def _versions() -> dict[str, str]:
    import platform
    from importlib.metadata import version

    from .. import __version__

    packages = ("moderngl", "glcontext", "numpy", "flip-evaluator")
    return {"mfr-bench": __version__, "python": platform.python_version(), "system": platform.platform(),
            **{name: version(name) for name in packages}}


COMMANDS = (run,)
