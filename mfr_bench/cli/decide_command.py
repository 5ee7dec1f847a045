"""`decide`: from a question to a method: the candidates race on the question's scene, and the slower leave early."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from pathlib import Path

import click

from .endings import NOTHING_KEEPS, UNTOLD
from .mesh_scene import MESH_CONFIG, overrides_of, own_scene
from .options import (
    DEVICE,
    JSON,
    OUTSIDE,
    WITHIN,
    ConfigName,
    InPath,
    NumberRange,
    OutPath,
    WholeRange,
    pixels,
    seconds,
)
from .output import note, say, width

MODEL_SHARE = 0.25  # of the time, at most, to ask a model how many layers keep the error
MESH_DEEPER = 2  # times the layers that a plan expects of a mesh, since a device finds more in some pixels


def _error(context, param, value: str) -> float:
    """A callback of click: an error such as 1/255 as a number. Raises UsageError where it is none."""
    from ..decide.question import parsed_error

    return parsed_error(value)


@click.command()
@click.option("--size", metavar="WxH", callback=pixels, help="Viewport in pixels, such as 1280x720.")
@click.option("--layers", metavar="N", type=WholeRange(1, 4096), help="Most fragments of any pixel.")
@click.option("--covered", metavar="SHARE", type=NumberRange(0, 1, min_open=True), default=1.0, show_default=True,
              help="Share of the pixels with fragments.")
@own_scene()
@click.option("--config", metavar="CONFIG", type=ConfigName(),
              help="Take the scene of this config's first cell instead.")
@click.option("--memory-mb", metavar="MIB", type=NumberRange(0, 2**24, min_open=True),
              help="Most memory of the method, in MiB.")
@click.option("--max-error", metavar="E", callback=_error, default="0", show_default=True,
              help="Largest error of a channel, such as 0.01 or 1/255; 0: exact images only.")
@click.option("--time-budget", "budget_s", metavar="T", callback=seconds, default="2m", show_default=True,
              help="Most time from the start of the command to its end: 90s, 2m.")
@click.option("--out", metavar="DIR", type=OutPath(file_okay=False),
              help="Where results go. [default: results/<device>/decide-<hash>]")
@click.option("--devices", "measured", multiple=True, metavar="DIR", type=InPath(),
              help="Measure nothing: answer from what this command measured on several devices, at or below DIR.")
@WITHIN
@DEVICE
@JSON
@OUTSIDE
def decide(size: tuple[int, int] | None, layers: int | None, covered: float, mesh: str | None, fragments: str | None,
           config: str | None, memory_mb: float | None, max_error: float, budget_s: float, out: str | None,
           measured: tuple[str, ...], within: float, device: str, as_json: bool) -> int:
    """Name the fastest method that keeps an error and a memory, and say how sure that is.

    Methods that cannot keep the bounds are excluded by what they declare. The others draw frames in turns; the clearly
    slower leave early, and the time goes to those that are close. What was measured on this device before is used.
    The command ends within --time-budget, on a loaded machine too; what this cut is listed with the answer.
    Exit status 6: nothing keeps the bounds; 1: no candidate was measured, for lack of time or on a device
    that fails its self-tests.

    \b
    Examples:
      mfr-bench decide --size 1280x720 --layers 24 --covered 0.3 --memory-mb 64
      mfr-bench decide --mesh model.glb --size 1280x720 --max-error 0.01
      mfr-bench decide --fragments recorded.npz
      mfr-bench decide --config smoke --time-budget 1m --json
      mfr-bench decide --size 1280x720 --layers 24 --covered 0.3 --devices results
    """
    from ..decide.budget import budget

    whole = budget(budget_s)
    question, scene = _asked(size, layers, covered, overrides_of(mesh, fragments, settable=False), config,
                             memory_mb, max_error)
    if measured:
        _answer_over(measured, question, scene, within, as_json)
        return 0
    answer = _raced(question, scene, whole, out, device)
    say(json.dumps(answer.record(), indent=2, ensure_ascii=False) if as_json else answer.text(width()))
    return 0 if answer.best else UNTOLD if answer.untried or answer.failed_trials else NOTHING_KEEPS


def _asked(size: tuple[int, int] | None, layers: int | None, covered: float, own: list[str], config: str | None,
           memory_mb: float | None, max_error: float):
    """The question, and the scene as a config has it. Raises UsageError where the options say no scene or two.

    own: the settings of a scene of one's own, from a file; none without one.
    """
    from ..decide.experiment import scene_of
    from ..decide.question import EXACT_ERROR, Question
    from ..errors import UsageError

    error = max(max_error, EXACT_ERROR)
    if own:
        if config is not None or layers is not None:
            raise UsageError("decide: a file with --config or --layers; allowed: one way to give the scene")
        more = () if size is None else (f"scene.size={list(size)}",)
        return _of_config(MESH_CONFIG, memory_mb, error, (*own, *more))
    if config is None:
        if size is None or layers is None:
            raise UsageError("decide: no scene; allowed: --size with --layers, --mesh, --fragments, or --config; "
                             "mfr-bench decide --help has examples")
        question = Question(size, layers, covered, memory_mb, error)
        return question, scene_of(question)
    if size is not None or layers is not None:
        raise UsageError("decide: --config with --size or --layers; allowed: one way to give the scene")
    return _of_config(config, memory_mb, error)


def _of_config(config: str, memory_mb: float | None, error: float, overrides: tuple[str, ...] = ()):
    from ..decide.question import Question
    from ..methods import catalog
    from ..plan import expand, expected_stats
    from ..scene.kinds import kind_of
    from .mesh_scene import as_written
    from .options import first_experiment

    cell = expand(first_experiment(config, None, overrides), catalog())[0]
    stats, measured = expected_stats(cell.scene), kind_of(cell.scene).measured
    covered = sum(stats.histogram[1:]) / stats.P
    layers = MESH_DEEPER * stats.n if measured else stats.n
    return Question(tuple(cell.scene.size), layers, covered, memory_mb, error, measured), as_written(cell.scene)


def _answer_over(folders: tuple[str, ...], question, scene, within: float, as_json: bool) -> None:
    """Answer from the races for this question on several devices. Raises UsageError where there are not two."""
    from ..decide.experiment import config_of
    from ..errors import UsageError
    from .options import results_below
    from .over_devices import over_devices

    name = config_of(question, scene, (), 1.0)["name"]
    races = [folder for folder in results_below(folders) if folder.manifest().get("name") == name]
    if len(races) < 2:
        raise UsageError(f"decide: {len(races) or 'no'} results of {name} in {', '.join(folders)}; allowed: those of "
                         "several devices; run the same command without --devices on each, then merge or copy them")
    over_devices("decide", races, "max_error_all", question.max_error, question.memory_mb, within, as_json)


def _raced(question, scene, budget, out: str | None, device: str):
    """Let the candidates race within the time that is left, and read the rows."""
    from ..run.process import Worker

    worker = Worker(device)  # it starts while the rest is imported
    from tempfile import TemporaryDirectory

    from ..decide.answer import answer_of
    from ..decide.candidates import within_time
    from ..report.data import load
    from ..run.supervisor import Supervisor
    from ..store.files import write_file
    from .interruption import Interruption
    from .progress import exact_duration

    with Interruption() as interruption, Supervisor(device, interruption.asked, worker) as supervisor, \
            TemporaryDirectory() as folder, interruption.at_once():
        if question.estimated:
            question = _counted(question, scene, supervisor, interruption, budget, Path(folder, "count"))
        found, excluded = _candidates(question, scene, budget)
        path = _written(Path(folder, "decide.yaml"), question, scene, found, budget)
        forbidden = _forbidden(path, supervisor.ready().limits)
        found, excluded = within_time(found, excluded, budget.seconds, forbidden)
        racing = sum(each.label not in forbidden for each in found)
        note(f"{racing} candidates; the answer comes within {exact_duration(budget.seconds)} of the start")
        _written(path, question, scene, found, budget)
        results, late, cut = _measured(question, path, {each.label: each.written for each in found}, supervisor,
                                       interruption, out, budget)
        kept = results.path / path.name
        write_file(kept, path.read_bytes())
    return answer_of(question, load(results), [*excluded, *late], str(kept), cut)


def _written(path: Path, question, scene, found, budget) -> Path:
    """The file, with the config that lets these candidates race."""
    import yaml

    from ..decide.experiment import config_of

    made = config_of(question, scene, found, budget.seconds)
    path.write_text(yaml.safe_dump(made, sort_keys=False, allow_unicode=True), encoding="utf-8")
    return path


def _forbidden(config: Path, limits) -> set[str]:
    """The labels of the config's cells that the device, the method or the memory budget forbids."""
    from ..methods import catalog
    from ..plan import forbidden
    from .run_command import plans_of

    (_, cells), = plans_of([str(config)], None, None, ())
    return forbidden({cell.label: cell for cell in cells}, catalog(), limits)


def _counted(question, scene, supervisor, interruption, budget, folder: Path):
    """The question with the layers and the coverage that the device finds; as it is where no time was left."""
    from dataclasses import replace

    import yaml

    from ..decide.experiment import count_of
    from .budgeted_session import CountingSession
    from .run_command import plans_of

    folder.mkdir()
    path = folder / "count.yaml"
    path.write_text(yaml.safe_dump(count_of(scene, budget.seconds), sort_keys=False, allow_unicode=True),
                    encoding="utf-8")
    session = CountingSession(supervisor, interruption, str(folder / "out"), budget)
    session.run(plans_of([str(path)], None, None, ()))
    values = next((cell["values"] for cell in session.folder.cells()), {})
    layers, covered = values.get("max_fragments"), values.get("covered_pixels")
    if not layers or not covered:
        return question
    width, height = question.size
    return replace(question, layers=layers, covered=covered / (width * height), estimated=False)


def _candidates(question, scene, budget):
    from ..decide.candidates import candidates
    from ..decide.model import enough_layers
    from ..methods import catalog
    from ..scene import Scene, generate

    enough = None
    if not question.exact and scene.get("kind", "quads") == "quads" and not scene.get("slant"):
        parsed = Scene(**{k: tuple(v) if isinstance(v, list) else v for k, v in scene.items()})
        until = time.monotonic() + MODEL_SHARE * budget.left_s()
        enough = enough_layers(generate(parsed), question.max_error, until)
        note(f"the nearest {enough} layers keep the error")
    return candidates(catalog(), question, enough)


def _measured(question, config: Path, written: Mapping[str, str], supervisor, interruption, out: str | None, budget):
    """The result folder of the config, measured where it lacks something; nothing is printed on stdout.

    With it come the candidates that have no row, and what else the budget cut, in words. written: by their labels, the
    candidates as a command takes them.
    """
    from ..decide.answer import answer_of
    from ..decide.candidates import NOT_FINISHED, Excluded
    from ..report.data import load
    from .budgeted_session import BudgetedSession
    from .run_command import plans_of

    session = BudgetedSession(supervisor, interruption, out, budget,
                              lambda folder: answer_of(question, load(folder), (), "").marked)
    session.run(plans_of([str(config)], None, None, ()))
    late = [written[label] for label in session.late if label in written]  # the floor is no candidate
    return session.folder, [Excluded(name, NOT_FINISHED) for name in late], session.cut
