"""`claims`: which of the papers' sentences measurements bear out; from the store alone, no GL."""

from __future__ import annotations

import click

from ..errors import UsageError
from .options import FOLDERS, JSON, MARKDOWN
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
    from ..store import ResultFolder, find_results

    if as_json + as_csv + as_matrix + as_markdown > 1:
        raise UsageError("claims: more than one of --json, --csv, --devices and --markdown; allowed: one, "
                         "or none for text")
    results = [ResultFolder(path) for path in find_results(folders)]
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
