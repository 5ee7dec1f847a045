"""A scene whose cells do not all fit the time that is left: the first of them are measured before others are begun."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from mfr_bench.run.events import Begun, Finished

from .planted_cells import MEASURE, Clock, Run, cell

METHODS = ("floor", "zbuffer", "ab-array", "ab-ll", "ab-sb")
LONG = replace(MEASURE, time_limit_s=600)  # far more than anything here takes


def order(device, folder, until, measure=LONG):
    """The methods of all cells, as each is begun and as its row comes: (method, whether it is the row)."""
    made = Run(device, [cell(method, measure=measure) for method in METHODS], Clock(), folder)
    made.all(until=until)
    assert made.sheet.counts == {"ok": len(METHODS)}
    method = {key: job.cell.method for key, job in made.sheet.jobs.items()}
    first = {}
    for event in made.events:
        if isinstance(event, Begun | Finished) and event.key in method:
            first.setdefault((method[event.key], isinstance(event, Finished)))
    return list(first)


@pytest.mark.parametrize(("left_s", "together"), [(0, 1), (300, 1), (500, 2), (800, 3), (float("inf"), len(METHODS))])
def test_no_more_cells_are_begun_than_can_be_sampled(device, tmp_path, left_s, together):
    """Half of each time limit, 300 s, is reckoned with; all cells are measured in the end, as nothing took so long."""
    begun_and_ended = order(device, tmp_path, time.monotonic() + left_s)
    ends = [i for i, (_, ended) in enumerate(begun_and_ended) if ended]
    assert ends[0] == together
    assert len(ends) == len(METHODS)
