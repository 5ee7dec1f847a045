"""SIGKILL at any moment loses at most the batch in hand: rows and samples stay, and the run ends with all of them."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import time
from pathlib import Path

from mfr_bench.store import ResultFolder
from mfr_bench.store.journal import Journal

from ..cli.conftest import environment
from ..patience import PATIENCE_S
from .fake_worker import BATCH, BATCHES
from .planted_run import CELLS

KILLS = 50
WHOLE = list(map(float, range(BATCHES * BATCH)))


def begun(folder: Path) -> subprocess.Popen:
    return subprocess.Popen([sys.executable, "-m", "tests.run.planted_run", str(folder)], env=environment(),
                            cwd=Path(__file__).parents[2], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def state(path: Path) -> dict[str, int]:
    """Samples by key that are kept, in rows and in the journal; every one in order, every file whole."""
    folder = ResultFolder(path)
    found = {}
    for cell in folder.cells():
        assert cell["samples_ms"] == WHOLE
        found[cell["key"]] = len(WHOLE)
    for key, partial in Journal(folder.journal_path).partials.items():
        assert partial.samples_ms == WHOLE[:len(partial.samples_ms)]
        found.setdefault(key, len(partial.samples_ms))
    assert folder.damaged == []
    return found


def test_fifty_kills_at_random_moments_lose_nothing(tmp_path):
    folder = tmp_path / "out"
    moments = random.Random(5)  # noqa: S311 - of kills
    before, gained = {}, 0
    for number in range(KILLS):
        process = begun(folder)
        if number % 5:
            process.stdout.read(moments.randint(1, 8))
            time.sleep(moments.uniform(0, 0.01))
        else:
            time.sleep(moments.uniform(0, 0.4))  # while it starts, most likely
        process.kill()
        _, complaints = process.communicate()
        assert complaints == ""
        after = state(folder)
        assert all(after.get(key, 0) >= count for key, count in before.items()), number
        gained += after != before
        before = after
    assert gained >= KILLS / 2  # the kills hit runs at work
    assert any(count == len(WHOLE) for count in before.values())

    process = begun(folder)
    out, complaints = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, complaints) == (0, "")
    assert len(out) == CELLS * BATCHES - sum(before.values()) // BATCH
    cells = ResultFolder(folder).cells()
    assert len(cells) == CELLS
    assert all(cell["samples_ms"] == WHOLE for cell in cells)
    assert max(cell["values"]["sessions"] for cell in cells) > 1
    assert not (folder / "unfinished.jsonl").exists()
    assert json.loads(next((folder / "cells").glob("*.json")).read_text())["status"] == "ok"
