"""Runs of small cells: on the session's device, and with workers that are actors."""

from __future__ import annotations

import pytest

from .acting import Stage
from .planted_cells import Clock, Run


@pytest.fixture
def play(tmp_path, monkeypatch):
    """play(cells, *actors, **more) -> the stage after the run."""
    return lambda *args, **more: Stage(tmp_path / "out", monkeypatch, *args, **more)


@pytest.fixture
def run(device, tmp_path):
    """run(cells, timer, **more) -> (rows by label and k, the run)"""
    def measured(cells, timer=None, force=False, **more):
        made = Run(device, cells, timer or Clock(), tmp_path, **more)
        made.all(force)
        return {(r["method"], r["params"].get("k")): r for r in made.rows}, made
    return measured
