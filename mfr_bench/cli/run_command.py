"""`run`: measure what is missing, then write tables and figures."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .interruption import Interruption
from .mesh_scene import MESH_CONFIG, overrides_of, own_scene
from .options import JSON, JUNIT, SUMMARY, ConfigName, NumberRange, OutPath, Share, measuring, pixels, seconds

if TYPE_CHECKING:
    from .session import Choices


@click.command()
@click.argument("configs", nargs=-1, metavar="CONFIG...", type=ConfigName())
@own_scene(" Without a CONFIG every method draws it.")
@click.option("--size", metavar="WxH", callback=pixels, help="Viewport of the scene in pixels, such as 1280x720.")
@click.option("--memory-mb", metavar="MIB", type=NumberRange(0, 2**24, min_open=True),
              help="Most memory of a method, in MiB. Dynamic k-buffers choose a k within it; methods that need more "
                   "are left out, with a reason; where it names a parameter, give it by --set, as memory_mb=64.")
@click.option("--shard", type=Share(), metavar="I/N",
              help="Measure the I-th of N shares of the scenes: one machine each; mfr-bench merge joins them, and plot "
                   "draws them.")
@click.option("--split", "split_s", metavar="TIME", callback=seconds, help="With --shard: split a scene whose forecast "
              "exceeds TIME by methods, as 30m or 2h; those of a group still draw in turns.")
@measuring("configs", "<config name>")
@click.option("--report", "page", metavar="F.html", type=OutPath(dir_okay=False),
              help="Write one HTML page of the results to F, as `report` does.")
@JUNIT
@SUMMARY
@JSON
def run(configs: tuple[str, ...], mesh: str | None, fragments: str | None, size: tuple[int, int] | None,
        memory_mb: float | None, shard: tuple[int, int] | None, split_s: float | None, out: str | None,
        profile: str | None, only: str | None, overrides: tuple[str, ...], device: str, force: bool, keep_failed: bool,
        try_hopeless: bool, budget_s: float | None, dry_run: bool, quiet: bool, page: str | None, junit: str | None,
        summary: str | None, as_json: bool) -> int:
    """Measure what the results lack, then write tables and figures.

    CONFIG is a file, a folder of files, or the name of a shipped config (see mfr-bench configs). What several
    configs need is measured once. A cell that crashes, hangs or runs out of memory costs itself alone, and is
    measured again by the next run; a run that was killed goes on where it was.

    \b
    Examples:
      mfr-bench run smoke
      mfr-bench run kplus2015-fig6 --profile smoke --out /tmp/fig6
      mfr-bench run smoke --only kplus-array,kplus-heap --set k=32
      mfr-bench run smoke --set scene.order=back_to_front --force
      mfr-bench run --mesh model.glb --size 1280x720 --memory-mb 64
      mfr-bench run --fragments recorded.npz
      mfr-bench run smoke --shard 2/4 --out node2
      mfr-bench run kplus2015-fig6 --shard 2/4 --split 30m --dry-run
    """
    from ..errors import UsageError
    from .session import Choices

    if split_s is not None and shard is None:
        raise UsageError("run: --split without --shard; allowed: with --shard I/N, whose shares it splits scenes for")
    settings = (*(word for each in overrides for word in ("--set", each)), *(("--only", only) if only else ()))
    configs, overrides = with_scene(configs, overrides, overrides_of(mesh, fragments), size, memory_mb)
    statuses = carry_out(partial(plans_of, configs, profile, only, overrides, shard, split_s), device,
                         Choices(out, force, keep_failed, try_hopeless, budget_s, quiet, as_json, junit, summary,
                                 page, drawn=shard is None, settings=settings),
                         dry_run)
    return exit_status(statuses)


def with_scene(configs: Sequence[str], overrides: Sequence[str], scene: Sequence[str],
               size: tuple[int, int] | None, memory_mb: float | None) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The configs and overrides that a scene of one's own, --size and --memory-mb come to.

    scene: the overrides of the scene, if any. Raises click.MissingParameter without any config.
    """

    given = [*scene]
    if scene:
        configs = configs or (MESH_CONFIG,)
    if size is not None:
        given.append(f"scene.size={list(size)}")
    if memory_mb is not None:
        given.append(f"measure.memory_budget_mb={memory_mb}")
    if not configs:
        raise click.MissingParameter(ctx=click.get_current_context(), param_type="argument",
                                     param_hint="'CONFIG...', --mesh FILE or --fragments FILE")
    return tuple(configs), (*given, *overrides)


def exit_status(statuses: set[str], wrong_images: bool = True) -> int:
    """The exit status of a run by its cells' statuses; without `wrong_images` those of measured cells are 0."""
    from ..store.status import STATUSES

    endings = [STATUSES[name] for name in statuses]
    return max((ending.exit_status for ending in endings if wrong_images or not ending.timed), default=0)


def carry_out(plans_made: Callable[[], Any], device: str, choices: Choices, dry_run: bool,
              table: Callable[[Any, int], str] | None = None) -> set[str]:
    """Measure the plans, which are made while the device is opened; the statuses of all cells, of a dry run none."""
    from ..run.process import Worker

    started = time.perf_counter()
    worker = Worker(device)  # it starts while the rest is imported
    from ..methods import catalog
    from ..plan import features_for
    from ..run.events import Needs
    from ..run.supervisor import Supervisor
    from .plan_text import print_plans
    from .session import Session

    with (Interruption() as interruption, Supervisor(device, interruption.asked, worker) as supervisor,
          interruption.at_once()):
        plans = plans_made()
        cells = [cell for _, cells in plans for cell in cells]
        supervisor.expect(Needs(features_for(cells, catalog()), len(cells)))
        if dry_run:
            print_plans(plans, supervisor, choices, started)
            return set()
        return Session(supervisor, interruption, choices, started, table).run(plans)


def plans_of(configs: Sequence[str], profile: str | None, only: str | None, overrides: Sequence[str],
             share: tuple[int, int] | None = None, split_s: float | None = None):
    """Every experiment with its cells; without cells where --only or --shard leaves none of them, but of another's.

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
    return plans if share is None else _shared(plans, *share, split_s)


def _shared(plans, number: int, count: int, split_s: float | None):
    """The share of a run. Raises UsageError where it has no cell: a scene is shared only where it is split."""
    from ..errors import UsageError
    from ..plan.shards import shards, split_lines, units_of
    from .output import note

    units = units_of(plans, split_s)
    mine = shards(plans, units, count)[number - 1]
    for line in split_lines(units.splits):
        note(line)
    if not any(cells for _, cells in mine):
        scenes = len(units.seconds)
        raise UsageError(f"--shard {number}/{count}: has no cell, since a scene is never shared; allowed: shares of "
                         f"{scenes} scenes, such as {number}/{scenes}" if number <= scenes else
                         f"--shard {number}/{count}: has no cell; allowed: at most {scenes} shares, one for each scene")
    return mine


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
