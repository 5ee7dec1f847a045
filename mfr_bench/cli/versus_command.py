"""`versus`: two source trees or revisions, measured in turns."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import click

from ..errors import UsageError
from .compare_command import handed_over, printed, status_of
from .endings import note_blame
from .interruption import Interruption
from .options import (
    CSV,
    DEVICE,
    JSON,
    JUNIT,
    MARKDOWN,
    ONLY,
    OUTSIDE,
    PROFILE,
    QUIET,
    SET,
    SUMMARY,
    THRESHOLD,
    WHOLE,
    NumberRange,
    OutPath,
    WholeRange,
    hold_one_form,
)
from .output import note


@click.command()
@click.argument("names", nargs=-1, required=True, metavar="A B CONFIG")
@click.option("--against", metavar="A", help="The tree or revision to compare with: `versus B CONFIG --against A`.")
@THRESHOLD
@click.option("--rounds", metavar="N", type=WholeRange(2, 50), default=6, show_default=True,
              help="Pairs of fresh processes, in each of which every cell is measured.")
@click.option("--seconds", metavar="S", type=NumberRange(0, 3600, min_open=True), default=1.0, show_default=True,
              help="Time of a cell in a round, about.")
@click.option("--out", metavar="DIR", type=OutPath(file_okay=False),
              help="Keep what was measured, as results in DIR/before and DIR/after, which are not there yet.")
@PROFILE
@ONLY
@SET
@DEVICE
@OUTSIDE
@QUIET
@click.option("--strict", is_flag=True, help="End with status 5 also where any cell is UNCLEAR.")
@WHOLE
@JSON
@CSV
@MARKDOWN
@JUNIT
@SUMMARY
def versus(names: tuple[str, ...], against: str | None, threshold: float, rounds: int, seconds: float, out: str | None,
           profile: str | None, only: str | None, overrides: tuple[str, ...], device: str, quiet: bool, strict: bool,
           whole: bool, as_json: bool, as_csv: bool, as_markdown: bool, junit: str | None, summary: str | None) -> int:
    """Say where tree B is faster, slower or worse than tree A, on the cells of CONFIG.

    A and B are source trees of this program or folders of methods, or git revisions of the repository that this folder
    stands in. Two processes are up at once, each with the code of its tree, and draw batches of frames in turns: a load
    or a clock hits both, and is in no ratio. Every round starts new processes. Images are checked on both sides.
    The verdicts and exit statuses are those of compare.

    \b
    Examples:
      mfr-bench versus v0.1.0 HEAD smoke
      mfr-bench versus . smoke --against HEAD       # a shader edited in place
      mfr-bench versus ../old ../new smoke --only kplus-array --rounds 5
    """
    from tempfile import TemporaryDirectory

    from ..run.trust import AGAINST
    from ..versus.judge import judged
    from ..versus.lockstep import Ask, measure
    from ..versus.tree import tree

    hold_one_form("versus", json=as_json, csv=as_csv, markdown=as_markdown)
    before, after, config = _named(names, against)
    ask = Ask(_config_path(config), profile, tuple(only.split(",")) if only else None, overrides, device,
              rounds, seconds)
    _hold_free(out)
    with Interruption() as interruption, ExitStack() as stack:
        repository = Path(after) if against is not None and Path(after).is_dir() else Path()
        trees = tuple(stack.enter_context(tree(name, repository)) for name in (before, after))
        measured = measure(trees, ask, lambda done, of: None if quiet else note(f"{done} of {of} visits to every cell"),
                           asked=interruption.asked)
        folder = Path(out) if out else Path(stack.enter_context(TemporaryDirectory()))
        found = judged(measured, (before, after), folder, threshold)
    if not found.verdicts:
        raise UsageError(f"versus: {before} and {after} have no cell of {config} in common")
    printed(found, whole, as_json, as_csv, as_markdown)
    handed_over(found, junit, summary)
    if against_device := {half.status for side in measured.halves for half in side.values()} & set(AGAINST):
        note_blame(device, f"a cell is {max(against_device)}")
    return status_of(found, strict)


def _named(names: tuple[str, ...], against: str | None) -> tuple[str, str, str]:
    """The trees before and after, and the config. Raises UsageError for another number of names."""
    given = names if against is None else (against, *names)
    if len(given) != 3:
        raise UsageError(f"versus: {' '.join(names)}: allowed: A B CONFIG, or B CONFIG --against A")
    return given


def _hold_free(out: str | None) -> None:
    """Raise UsageError where the folder has results of a comparison before this one, which would count for this one."""
    for side in ("before", "after") if out else ():
        if (Path(out) / side / "manifest.json").exists():
            raise UsageError(f"--out {out}: has the results of another comparison; allowed: a folder without "
                             "before/ and after/")


def _config_path(reference: str) -> str:
    """The file of a config: both trees read the same one. Raises UsageError where it is none."""
    from ..config.loading import find

    files = find(reference)
    if len(files) != 1:
        raise UsageError(f"{reference}: {len(files)} configs; allowed: one file, or the name of a shipped config")
    return str(files[0].resolve())
