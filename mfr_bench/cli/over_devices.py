"""The answer of `advise` and `decide` for several devices at once, from the store alone."""

from __future__ import annotations

import click

from ..errors import UsageError
from .endings import NOTHING_KEEPS
from .output import note, say, width


def over_devices(command: str, folders, column: str, max_error: float, memory_mb: float | None, within: float,
                 as_json: bool) -> None:
    """Print the best on the worst device, and what is near the best on all, for each scene of several devices.

    Raises UsageError where no scene was measured by several devices; exit status 6 where nothing keeps the bounds.
    """
    from ..report.devices import Limits, answers, answers_json, answers_text, read_experiments

    found = answers(read_experiments(folders, whole_scenes=True), Limits(column, max_error, memory_mb), within)
    if not found:
        raise UsageError(f"{command}: no scene of these results was measured on several devices; allowed: folders with "
                         "one experiment of each device")
    say(answers_json(found) if as_json else answers_text(found, width()))
    for folder in folders:
        for line in folder.damaged:
            note(line)
    if not any(answer.rows for answer in found):
        click.get_current_context().exit(NOTHING_KEEPS)
