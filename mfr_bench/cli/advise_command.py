"""`advise`: which measured method to take; from the store alone, no GL."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

import click

from ..errors import UsageError, nearest
from .endings import NOTHING_KEEPS
from .options import JSON, WITHIN, ConfigName, OneOf
from .output import note, say, width


class Positive(click.ParamType):
    """A number above 0, up to `most`, or a fraction such as 1/255."""

    name = "number"

    def __init__(self, most: float = math.inf):
        self._most = most

    def convert(self, value, param, context):
        over, slash, under = str(value).partition("/")
        try:
            number = float(over) / float(under if slash else 1)
        except (ValueError, ZeroDivisionError):
            number = math.nan
        if not 0 < number <= self._most or number == math.inf:
            upper = "" if self._most == math.inf else f", up to {self._most:g}, or a fraction such as 1/255"
            self.fail(f"{value!r} is not allowed; allowed: a number above 0{upper}")
        return number


class SceneKeys(click.ParamType):
    """Keys of a scene with their values: size=1280x720,n=24,alpha=0.5."""

    name = "text"

    def convert(self, value, param, context):
        from ..store.columns import COLUMNS, names

        known = ["size", "n", "p_d", "f_p", "alpha", "kind", "layout", *names(COLUMNS, "place")]
        found = {}
        for part in value.split(","):
            name, separator, text = (piece.strip() for piece in part.partition("="))
            if not separator or not text or name not in known:
                self.fail(f"{part!r} is not allowed; allowed: KEY=VALUE with KEY of {', '.join(known)}"
                          f"{nearest(name, known)}")
            found[name] = self._value(name, text)
        return found

    def _value(self, name: str, text: str):
        sides = text.split("x")
        if name == "size" and not (len(sides) == 2 and all(side.isdigit() and int(side) for side in sides)):
            self.fail(f"size={text} is not allowed; allowed: WxH in pixels, as in 1280x720")
        if name == "size":
            return tuple(map(int, sides))
        try:
            return float(text) if "." in text or "e" in text.lower() else int(text)
        except ValueError:
            return text


LARGEST_ERROR = 1.0  # between two images that a screen can show, by every metric
DEVICES = click.option("--devices", is_flag=True, help="One answer for all devices: the best on the worst device, and "
                       "what is near the best on each.")


def _found(context: click.Context, param: click.Parameter, targets: tuple[str, ...]) -> list[Path]:
    """The result folders that the targets mean: what is wrong with one is told before an option is missed."""
    return [] if context.resilient_parsing else _results(targets)


@click.command()
@click.argument("folders", nargs=-1, required=True, metavar="CONFIG|DIR...", type=ConfigName(), callback=_found)
@click.option("--max-error", type=Positive(LARGEST_ERROR), required=True, metavar="E",
              help="The error that an image may have against the float64 image of all fragments, as 0.01 or 1/255.")
@click.option("--memory-mb", type=Positive(), metavar="MIB", help="The MiB that a method may allocate; default: any.")
@click.option("--metric", type=OneOf(["rmse", "flip", "max"]), default="rmse", show_default=True,
              help="The error: root mean square, NVIDIA's FLIP, or the largest of any channel.")
@click.option("--scene", "--like", "like", metavar="KEY=VALUE,...", type=SceneKeys(),
              help="Only the measured scene that is nearest to this one: size=1280x720,n=24,p_d=0.3.")
@DEVICES
@WITHIN
@JSON
@click.pass_context
def advise(context: click.Context, folders: list[Path], max_error: float, memory_mb: float | None, metric: str,
           like: dict | None, devices: bool, within: float, as_json: bool) -> None:
    """Name the fastest method within an error and a memory budget.

    Scene by scene, from what was measured: the method with its parameters, those that come next with
    the interval of how much slower they are, and whether the fastest is told apart from them. Exit
    status 6 where nothing measured keeps the bounds.

    \b
    Examples: mfr-bench advise pareto --max-error 0.01 --memory-mb 64
              mfr-bench advise results --max-error 0.05 --metric flip --json
              mfr-bench advise pareto --max-error 0.01 --like size=1280x720,n=24
              mfr-bench advise results --max-error 1/255 --devices --within 10
    """
    from ..report import advice, data
    from ..store import ResultFolder

    results = [ResultFolder(path) for path in folders]
    if devices:
        from .over_devices import over_devices

        if like:
            raise UsageError("advise: --devices with --like; allowed: one of them")
        over_devices("advise", results, advice.METRICS[metric], max_error, memory_mb, within, as_json)
        return
    found = advice.advise(map(data.load, results), advice.Bounds(metric, max_error, memory_mb), like, _config_of)
    if not found:
        raise UsageError(f"advise: nothing is measured in {', '.join(str(f.path) for f in results)}; run "
                         "'mfr-bench run' again")
    say(advice.as_json(found) if as_json else advice.as_text(found, width()))
    for line in dict.fromkeys(warning for each in found for warning in each.warnings) if as_json else ():
        note(f"advise: {line}")
    for folder in results:
        for line in folder.damaged:
            note(line)
    if not any(each.kept for each in found):
        context.exit(NOTHING_KEEPS)


def _config_of(result) -> str:
    """The argument of `run` that measures the result again: a shipped config, or the file it was measured with."""
    from ..config import shipped

    name = str(result.manifest.get("config") or f"{result.name}.yaml")
    return Path(name).stem if Path(name).stem in shipped() else name if Path(name).is_file() else ""


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
    """The folders with results of the config's experiments, on any device."""
    from ..config import load
    from ..methods import catalog

    names = [experiment.name for experiment in load(target, catalog())]
    measured = [path.parent for name in names for path in sorted(Path("results").glob(f"*/{name}/manifest.json"))]
    if not measured:
        raise UsageError(f"{target}: nothing is measured in results/*/{names[0]}; run: mfr-bench run {target}, or give "
                         "the folder that it was measured into")
    return measured
