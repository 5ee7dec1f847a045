"""The sentences that the papers state, and whether measurements bear them out.

    papers/              the claims as data: source, sentence, the paper's finding, the experiments needed, the rules
    rules, memory_rules  what a rule can say: a ratio, a change, a straight line, a share, a value; memory, running out
    picks, measures      which cells a rule compares, and which quantities of them
    runs                 the cells of one experiment in one result folder
    evidence             a comparison with its interval, and how it is decided
    verdict              a claim judged on one device
    present              verdicts as text, Markdown, CSV and JSON
    fidelity             the page of what the papers say and what is done here

Cells are addressed by method, parameters, scene and sweep point, never by label; ratios are taken inside one run.
"""

from . import present
from .papers import CLAIMS
from .runs import load_runs, runs_of
from .verdict import judge_all

__all__ = ["CLAIMS", "judge_all", "load_runs", "present", "runs_of"]
