"""`race`: a method's own GLSL under an adversarial scheduler."""

from __future__ import annotations

import json

import click

from .options import JSON, OUTSIDE, MethodName, method
from .output import say

BROKEN = 3
SCHEDULES = 20_000


@click.command()
@click.argument("method_id", metavar="METHOD", type=MethodName())
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Set a parameter of METHOD, e.g. k=3; may "
              "be repeated. Without one, k is 2.")
@click.option("--fragments", default="3,2", show_default=True, metavar="N,...", help="The fragments of each pixel.")
@click.option("--schedules", type=click.IntRange(1), default=SCHEDULES, show_default=True,
              help="How many schedules are tried, over all scenes.")
@click.option("--scenes", type=click.IntRange(1, 1000), default=8, show_default=True,
              help="How many scenes, each with other colours and another order of submission.")
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="What the schedules are drawn from.")
@click.option("--ties", is_flag=True, help="Let the two nearest fragments of each pixel have one depth.")
@click.option("--weak", is_flag=True, help="Let plain stores reach memory late and word by word, and loads be early.")
@click.option("--no-dependencies", is_flag=True, help="With --weak: a load may be earlier than the one that its "
              "address came from, as in Vulkan's model without a barrier.")
@click.option("--warp", type=click.IntRange(2, 64), metavar="LANES", help="Run warps of so many lanes in lockstep.")
@click.option("--moved-returns", is_flag=True, help="With --warp: branches with a return end where the shader ends.")
@click.option("--ordered", is_flag=True, help="The interlock lets fragments through in order of submission.")
@click.option("--helpers", is_flag=True, help="Add a helper invocation to each pixel.")
@click.option("--exhaustive", type=click.IntRange(0, 8), metavar="BOUND",
              help="Try every schedule with at most so many preemptions, as far as --schedules allows.")
@click.option("--campaign", is_flag=True, help="Run METHOD, or with METHOD `all` every method, with each option that "
              "changes what runs concurrently, on strong and weak memory and in lockstep; a line for each.")
@click.option("--replay", metavar="WORD", help="Run the one schedule that an earlier run has printed.")
@JSON
@OUTSIDE
def race(method_id: str, overrides: tuple[str, ...], fragments: str, schedules: int, scenes: int, seed: int, ties: bool,
         weak: bool, no_dependencies: bool, warp: int | None, moved_returns: bool, ordered: bool, helpers: bool,
         exhaustive: int | None, campaign: bool, replay: str | None, as_json: bool) -> None:
    """Run the GLSL of METHOD under an adversarial scheduler.

    Without a GPU: its shaders are translated to C++ and every load, store and atomic may be interrupted by any other
    fragment. Where a promise of the method breaks, the shortest interleaving found is printed, and the exit status
    is 3. Needs a C++ compiler. What the machine does and leaves out: docs/races.md.

    \b
    Examples: mfr-bench race kplus-array --set k=2 --fragments 4
              mfr-bench race lin-pre --weak --json
              mfr-bench race all --campaign --schedules 100000
    """
    from ..race.campaign import run, small_variant
    from ..race.check import How
    from ..race.report import record, text
    from ..race.scenes import parse_counts

    counts = parse_counts(fragments)
    if campaign:
        _campaign(method_id, counts, How(schedules, seed), scenes)
        return
    variant = small_variant(method(method_id, "METHOD"), overrides)
    how = How(schedules, seed, weak, not no_dependencies, warp or 0, moved_returns, exhaustive is not None,
              exhaustive or 0, ordered, helpers)
    found = _replayed(variant, counts, how, ties, replay) if replay else run(variant, counts, how, scenes, ties)
    say(json.dumps(record(found), indent=2) if as_json else text(found))
    if found.broken and not found.checker.promises_nothing:
        click.get_current_context().exit(BROKEN)


def _replayed(variant, counts, how, ties: bool, word: str):
    """One schedule of an earlier run."""
    from ..race.campaign import Found, parse_replay
    from ..race.check import Checker
    from ..race.scenes import row_of

    scene, deviations = parse_replay(word)
    checker = Checker(variant, row_of(counts, scene, ties), how.helpers)
    failure = checker.replay(deviations, how)
    return Found(1, 0.0, int(failure is not None), 0, 0, False, checker, failure)


def _campaign(method_id: str, counts, how, scenes: int) -> None:
    """Prints a line for each configuration and machine, and ends with the status of a broken promise if one broke."""
    from ..methods import catalog
    from ..race.campaign import everything
    from ..race.options import configurations
    from ..race.report import headline
    from ..race.scenes import row_of

    chosen = catalog().values() if method_id == "all" else [method(method_id, "METHOD")]
    broken = 0
    for one in chosen:
        for kept in everything(one, configurations(one, row_of(counts), together=1), counts, how, scenes):
            say(f"{kept.machine:8} {headline(kept.found) if kept.found else kept.error}")
            broken += kept.broken
    say(f"{broken} broken")
    if broken:
        click.get_current_context().exit(BROKEN)
