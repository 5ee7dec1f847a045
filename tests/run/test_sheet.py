"""A run ends well only where the folder has every row that was written."""

from __future__ import annotations

import re

import pytest

from mfr_bench.errors import StoreError
from mfr_bench.methods import catalog
from mfr_bench.run.events import Finished
from mfr_bench.run.jobs import jobs
from mfr_bench.run.ledger import Ledger
from mfr_bench.run.sheet import Sheet
from mfr_bench.store import ResultFolder

from .fake_worker import DEVICE
from .planted_cells import cell


@pytest.fixture
def sheet(tmp_path):
    cells = [cell(method) for method in ("ab-array", "ab-ll", "ab-sb")]
    made = Sheet(ResultFolder(tmp_path), jobs(cells, catalog(), DEVICE, "wall"))
    ledger = Ledger([made], DEVICE)
    for job in made.pending[:2]:
        ledger.write(job, Finished(job.key, "unsupported", "as planted", {}))
    ledger.close()
    return made


def test_rows_that_are_there_are_enough_loose_or_packed(sheet):
    sheet.refuse_gone()
    sheet.folder.pack()
    sheet.refuse_gone()


def test_rows_that_were_removed_meanwhile_are_told_of(sheet):
    key = next(iter(sheet.statuses))
    (sheet.folder.cells_path / f"{key}.json").unlink()
    told = f"{sheet.folder.path}: of 2 cells that were written, 1 are no more there: another program has removed them; "
    with pytest.raises(StoreError, match=re.escape(told + "the same command measures them again")):
        sheet.refuse_gone()
