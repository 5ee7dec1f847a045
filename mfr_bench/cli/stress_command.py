"""`stress`: the shipped stressors through the same machinery as `run`; says where each method breaks."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from .options import measuring
from .output import say_lines
from .run_command import carry_out, exit_status, plans_of


class StressorName(click.ParamType):
    """The name of a shipped stressor."""

    name = "stressor"

    def convert(self, value, param, context):
        from ..errors import nearest

        names = stressors()
        if value not in names:
            self.fail(f"no stressor {value!r}; allowed: {', '.join(names)}{nearest(value, names)}")
        return value

    def shell_complete(self, context, param, incomplete):
        from click.shell_completion import CompletionItem

        return [CompletionItem(name) for name in stressors() if name.startswith(incomplete)]


def stressors() -> dict[str, Path]:
    """The shipped configs that put methods under stress, by name."""
    from ..config import stress_configs

    return stress_configs()


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME...]", type=StressorName())
@measuring("stressors", "stress-<name>")
@click.option("--list", "listed", is_flag=True, help="List the stressors.")
def stress(names: tuple[str, ...], out: str | None, profile: str | None, only: str | None,
           overrides: tuple[str, ...], device: str, force: bool, keep_failed: bool, try_hopeless: bool,
           budget_s: float | None, dry_run: bool, quiet: bool, listed: bool) -> int:
    """Find the first level of stress at which each method breaks.

    NAME is a stressor of --list; without any, all of them. Each is a config, whose levels go from mild to harsh. A
    method breaks where its image is beyond the promise, where it loses fragments, crashes, hangs, or is refused.
    A break is a result: the exit status is 1 only where a cell crashed, or ran out of time or memory.

    \b
    Examples:
      mfr-bench stress --list
      mfr-bench stress --profile smoke --dry-run
      mfr-bench stress --profile smoke --out /tmp/stress
      mfr-bench stress depth-gap equal-depths --only kb-mdt32,kplus-array
    """
    from ..config import load
    from ..methods import catalog
    from ..report import breaking_text
    from .session import Choices

    known = stressors()
    if listed:
        longest = max(map(len, known))
        say_lines("\n".join(f"{name:{longest}}  {load(str(path), catalog())[0].title}" for name, path in known.items()))
        return 0
    configs = [str(known[name]) for name in names or known]
    statuses = carry_out(partial(plans_of, configs, profile, only, overrides), device,
                         Choices(out, force, keep_failed, try_hopeless, budget_s, quiet), dry_run, breaking_text)
    return exit_status(statuses, wrong_images=False)  # to show them is what the command is for
