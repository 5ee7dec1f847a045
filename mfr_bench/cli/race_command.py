"""`race`: a method's own GLSL under an adversarial scheduler."""

from __future__ import annotations

import json
import shlex
from dataclasses import asdict
from pathlib import Path

import click

from ..errors import UsageError
from .endings import WRONG
from .options import JSON, OUTSIDE, MethodName, OutPath, WholeRange, method
from .output import say

OF_MODES = {  # what each of these ways to run takes
    "--campaign": ("campaign", "pairs", "jobs", "out", "fragments", "schedules", "scenes", "seed", "as_json"),
    "--hazards": ("hazards", "jobs", "out", "schedules", "seed"),
}
OF_A_SCHEDULE = ("schedules", "scenes", "seed", "exhaustive", "replay", "as_json")  # which --replay stands for
ONLY_THERE = ("pairs", "jobs", "out")
SCHEDULES = 20_000


@click.command()
@click.argument("method_id", metavar="METHOD", type=MethodName(), default="all")
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Set a parameter of METHOD, e.g. k=3; may "
              "be repeated. Without one, k is 2.")
@click.option("--fragments", default="3,2", show_default=True, metavar="N,...", help="The fragments of each pixel.")
@click.option("--schedules", metavar="N", type=WholeRange(1), default=SCHEDULES, show_default=True,
              help="How many schedules are tried, over all scenes.")
@click.option("--scenes", metavar="N", type=WholeRange(1, 1000), default=8, show_default=True,
              help="How many scenes, each with other colours and another order of submission.")
@click.option("--seed", metavar="N", type=WholeRange(0), default=1, show_default=True,
              help="What the schedules are drawn from.")
@click.option("--ties", is_flag=True, help="Let the two nearest fragments of each pixel have one depth.")
@click.option("--weak", is_flag=True, help="Let plain stores reach memory late and word by word, and loads be early; "
              "without it no missing barrier shows.")
@click.option("--no-dependencies", is_flag=True, help="With --weak: a load may be earlier than the one that its "
              "address came from, as in Vulkan's model without a barrier.")
@click.option("--warp", type=WholeRange(2, 64), metavar="LANES", help="Run warps of so many lanes in lockstep.")
@click.option("--moved-returns", is_flag=True, help="With --warp: branches with a return end where the shader ends.")
@click.option("--ordered", is_flag=True, help="The interlock lets fragments through in order of submission.")
@click.option("--helpers", is_flag=True, help="Add a helper invocation to each pixel.")
@click.option("--exhaustive", type=WholeRange(0, 8), metavar="BOUND",
              help="Try every schedule with at most so many preemptions, as far as --schedules allows.")
@click.option("--campaign", is_flag=True, help="Run METHOD, or with METHOD `all` every method, with each option that "
              "changes what runs concurrently, on strong and weak memory and in lockstep, as many schedules each; a "
              "line for each.")
@click.option("--pairs", is_flag=True, help="With --campaign: also any two such options at once.")
@click.option("--hazards", is_flag=True, help="Simulate what METHOD, or every method, loses where it promises nothing: "
              "a table of shares by fragments, k and number in flight, and for all a figure.")
@click.option("--jobs", type=WholeRange(1), metavar="N", help="With --campaign or --hazards: how many run side by "
              "side; one for each core unless given.")
@click.option("--out", type=OutPath(), default="results/races", show_default=True, metavar="DIR",
              help="With --campaign: the folder of races.csv; what it holds with as many schedules is not run again. "
              "With --hazards: where the simulated table and figure go.")
@click.option("--replay", metavar="WORD", help="Run the one schedule that an earlier run has printed.")
@JSON
@OUTSIDE
@click.pass_context
def race(context: click.Context, method_id: str, overrides: tuple[str, ...], fragments: str, schedules: int, scenes:
         int, seed: int, ties: bool, weak: bool, no_dependencies: bool, warp: int | None, moved_returns: bool,
         ordered: bool, helpers: bool, exhaustive: int | None, campaign: bool, pairs: bool, hazards: bool, jobs: int
         | None, out: str, replay: str | None, as_json: bool) -> None:
    """Run the GLSL of METHOD under an adversarial scheduler.

    Without a GPU: its shaders are translated to C++ and every load, store and atomic may be interrupted by any other
    fragment. Where a promise of the method breaks, the shortest interleaving found is printed, and the exit status
    is 3. Needs a C++ compiler. What the machine does and leaves out: docs/races.md.

    \b
    Examples: mfr-bench race kplus-array --set k=2 --fragments 4
              mfr-bench race lin-pre --weak --json
              mfr-bench race all --campaign --schedules 100000 --out results/races
              mfr-bench race all --hazards
    """
    from ..race.campaign import run, small_variant
    from ..race.check import How
    from ..race.report import record, text
    from ..race.scenes import parse_counts

    counts = parse_counts(fragments)
    _held_to(context, "--campaign" if campaign else "--hazards" if hazards else None)
    if hazards:
        _hazards(method_id, schedules, seed, jobs, Path(out))
        return
    if campaign:
        _campaign(context, _chosen(method_id), counts, How(schedules, seed), scenes, 1 + pairs, jobs, out, as_json)
        return
    if method_id == "all":
        raise UsageError("METHOD is missing; allowed: a method that 'mfr-bench methods' lists; all methods only with "
                         f"{' or '.join(OF_MODES)}")
    variant = small_variant(method(method_id, "METHOD"), overrides)
    how = How(schedules, seed, weak, not no_dependencies, warp or 0, moved_returns, exhaustive is not None,
              exhaustive or 0, ordered, helpers)
    found = (run(variant, counts, how, scenes, ties) if replay is None
             else _replayed(variant, counts, how, ties, replay))
    say(json.dumps(record(found), indent=2) if as_json else text(found, _again(context)))
    if found.broken and not found.checker.promises_nothing:
        context.exit(WRONG)


def _given(context: click.Context) -> dict[str, str]:
    """The options that the command line has, by the names of their parameters."""
    return {p.name: p.opts[0] for p in context.command.params if isinstance(p, click.Option) and p.name is not None
            and context.get_parameter_source(p.name) is click.core.ParameterSource.COMMANDLINE}


def _again(context: click.Context) -> str:
    """The command that runs the same machine again, all but the schedule."""
    words = ["mfr-bench", "race", context.params["method_id"]]
    for name, option in _given(context).items():
        if name in OF_A_SCHEDULE:
            continue
        value = tuple(context.meta["method_folders"]) if name == "method_folders" else context.params[name]
        for one in value if isinstance(value, tuple) else (value,):
            words += [option] if one is True else [option, str(one)]
    return shlex.join(words)


def _held_to(context: click.Context, mode: str | None) -> None:
    """Raises UsageError for options that say nothing where they stand."""
    given = _given(context)
    if mode is None:
        stray = [option for name, option in given.items() if name in ONLY_THERE]
        if stray:
            raise UsageError(f"{', '.join(stray)}: allowed only with {' or '.join(OF_MODES)}")
        return
    stray = [option for name, option in given.items() if name not in (*OF_MODES[mode], "method_folders")]
    if stray:
        raise UsageError(f"{', '.join(stray)}: not allowed with {mode}, which chooses machines and options itself")


def _chosen(method_id: str):
    from ..methods import catalog

    return list(catalog().values()) if method_id == "all" else [method(method_id, "METHOD")]


def _replayed(variant, counts, how, ties: bool, word: str):
    """One schedule of an earlier run."""
    from ..race.campaign import Found, parse_replay
    from ..race.check import Checker
    from ..race.scenes import row_of

    scene, deviations = parse_replay(word)
    checker = Checker(variant, row_of(counts, scene, ties), how.helpers)
    failure = checker.replay(deviations, how)
    return Found(1, 0.0, int(failure is not None), 0, 0, False, checker, failure)


def _campaign(context: click.Context, chosen, counts, how, scenes: int, together: int, at_once: int | None, out: str,
              as_json: bool) -> None:
    """Prints a line for each configuration and machine, and ends with the status of a broken promise if one broke."""
    from ..environment import usable_cores
    from ..race.report import campaign_end, campaign_line
    from ..race.sweep import jobs, sweep

    wanted, lines = jobs(chosen, counts, how, scenes, together), []
    for line in sweep(wanted, Path(out), at_once):
        lines.append(line)
        say(json.dumps(asdict(line)) if as_json else campaign_line(line))
    if not as_json:
        say(campaign_end(lines, at_once or usable_cores()))
    if any(line.broken for line in lines):
        context.exit(WRONG if any(line.violations for line in lines) else 1)


def _hazards(method_id: str, schedules: int, seed: int, at_once: int | None, folder: Path) -> None:
    """Writes the simulated table, and for all methods the simulated figure; prints the table."""
    from ..race.hazards import as_markdown, write
    from ..race.hazards import hazards as simulated

    found = list(simulated(_chosen(method_id), schedules, seed, at_once))
    if not found:
        raise UsageError(f"{method_id} promises its image with every option: there are no hazards to count")
    say(as_markdown(found))
    say(write(found, folder))
    for path in _pictured(folder, at_once) if method_id == "all" else ():
        say(path)


def _pictured(folder: Path, at_once: int | None) -> list[Path]:
    """The files of the simulated figure."""
    from ..methods import catalog
    from ..race.picture import panels, racing, sound, write

    above, below = racing(catalog()), sound(catalog())
    made = panels([*above, *below], at_once)
    return write(made[:len(above)], made[len(above):], folder)
