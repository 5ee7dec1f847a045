"""`claims`: which of the papers' sentences measurements bear out; from the store alone, no GL."""

from __future__ import annotations

import click

from .options import FOLDERS, JSON, MARKDOWN, hold_one_form, results_below
from .output import note, say, width


@click.command()
@FOLDERS
@JSON
@click.option("--csv", "as_csv", is_flag=True, help="Print CSV, a row per claim and device.")
@click.option("--devices", "as_matrix", is_flag=True, help="Print one Markdown table, a column per device.")
@MARKDOWN
def claims(folders: tuple[str, ...], as_json: bool, as_csv: bool, as_matrix: bool, as_markdown: bool) -> None:
    """Test what the papers claim on all results at or below DIR.

    Device by device. For each claim: its source, what the paper found, the rule, what was measured with its
    interval, and whether it holds, does not hold, or cannot be tested here, and why.

    \b
    Examples: mfr-bench claims results
              mfr-bench claims results --devices
              mfr-bench claims results --csv > claims.csv
    """
    from ..claims import CLAIMS, judge_all, load_runs, present

    hold_one_form("claims", json=as_json, csv=as_csv, devices=as_matrix, markdown=as_markdown)
    results = results_below(folders)
    verdicts = judge_all(CLAIMS, load_runs(results))
    if as_json:
        say(present.as_json(verdicts))
    elif as_matrix:
        say(present.as_matrix(verdicts))
    elif as_csv:
        say(present.as_csv(verdicts).rstrip("\n"))
    else:
        say(present.as_markdown(verdicts) if as_markdown else present.as_text(verdicts, width()))
    for folder in results:
        for line in folder.damaged:
            note(line)
