"""`advise`: which measured method to take; from the store alone, no GL."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

import click

from ..errors import UsageError
from .options import JSON, ConfigName, OneOf
from .output import note, say, width


class Positive(click.ParamType):
    """A number above 0."""

    name = "number"

    def convert(self, value, param, context):
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not 0 < number < math.inf:
            self.fail(f"{value!r} is not allowed; allowed: a number above 0")
        return number


@click.command()
@click.argument("targets", nargs=-1, required=True, metavar="CONFIG|DIR...", type=ConfigName())
@click.option("--max-error", type=Positive(), required=True, metavar="E",
              help="The error that an image may have, against the float64 image of all fragments.")
@click.option("--memory-mb", type=Positive(), metavar="M", help="The MiB that a method may allocate; default: any.")
@click.option("--metric", type=OneOf(["rmse", "flip", "max"]), default="rmse", show_default=True,
              help="The error: root mean square, NVIDIA's FLIP, or the largest of any channel.")
@JSON
def advise(targets: tuple[str, ...], max_error: float, memory_mb: float | None, metric: str, as_json: bool) -> None:
    """Name the fastest method within an error and a memory budget.

    Scene by scene, from what was measured: the method with its parameters, those that come next with
    the interval of how much slower they are, and whether the fastest is told apart from them.

    \b
    Examples: mfr-bench advise pareto --max-error 0.01 --memory-mb 64
              mfr-bench advise results --max-error 0.05 --metric flip --json
    """
    from ..report import advice, data
    from ..store import ResultFolder

    folders = [ResultFolder(path) for path in _results(targets)]
    found = advice.advise(map(data.load, folders), advice.Limits(metric, max_error, memory_mb))
    if not found:
        raise UsageError(f"advise: nothing is measured in {', '.join(str(f.path) for f in folders)}; run "
                         "'mfr-bench run' again")
    say(advice.as_json(found) if as_json else advice.as_text(found, width()))
    for folder in folders:
        for line in folder.damaged:
            note(line)


def _results(targets: Iterable[str]) -> list[Path]:
    """The result folders of configs, and those at or below directories. Raises UsageError with what to run."""
    from ..store import find_results

    found: dict[Path, None] = {}
    for target in targets:
        folder = Path(target)
        holds_results = folder.is_dir() and (any(folder.rglob("manifest.json")) or not any(folder.glob("*.yaml")))
        found.update(dict.fromkeys(find_results([target]) if holds_results else _of_config(target)))
    return list(found)


def _of_config(target: str) -> list[Path]:
    """Where the config's experiments were measured, on any device."""
    from ..config import load
    from ..methods import catalog

    names = [experiment.name for experiment in load(target, catalog())]
    measured = [path.parent for name in names for path in sorted(Path("results").glob(f"*/{name}/manifest.json"))]
    if not measured:
        raise UsageError(f"{target}: nothing is measured in results/*/{names[0]}; run: mfr-bench run {target}, or give "
                         "the folder that it was measured into")
    return measured
