"""The journal: what a killed run has taken of cells that are not done."""

from __future__ import annotations

import os

import pytest

from mfr_bench.errors import StoreError
from mfr_bench.store.journal import Journal


@pytest.fixture
def path(tmp_path):
    return tmp_path / "out" / "unfinished.jsonl"


def filled(path) -> Journal:
    journal = Journal(path)
    journal.add("a", "first", [1.0, 2.0], {"store": [0.5]})
    journal.add("b", "first", [7.0], {})
    journal.add("a", "second", [3.0], {"store": [0.25], "resolve": [1.0]})
    return journal


def test_batches_add_up_and_sessions_are_counted(path):
    filled(path)
    found = Journal(path).partials  # the first is not closed, as after SIGKILL
    assert found["a"].samples_ms == [1.0, 2.0, 3.0]
    assert found["a"].passes == {"store": [0.5, 0.25], "resolve": [1.0]}
    assert (found["a"].sessions, found["b"].sessions) == (2, 1)


def test_nothing_is_written_before_the_first_batch_and_nothing_is_left_after_the_last_cell(path):
    Journal(path).close()
    assert not path.parent.exists()
    journal = filled(path)
    journal.forget("a")
    assert set(Journal(path).partials) == {"b"}
    journal.forget("b")
    assert not path.exists()


def test_only_what_is_new_is_synced(path, monkeypatch):
    journal, synced = filled(path), []
    monkeypatch.setattr(os, "fsync", synced.append)
    journal.sync()
    journal.sync()
    journal.forget("a")
    journal.sync()
    assert len(synced) == 1


def test_a_cell_that_is_done_stays_so_even_if_its_row_is_lost_later(path):
    filled(path).forget("a")
    journal = Journal(path)
    journal.add("c", "third", [1.0], {})
    assert set(Journal(path).partials) == {"b", "c"}
    assert b'"a"' not in path.read_bytes()


@pytest.mark.parametrize("cut", range(1, 40))
def test_a_line_that_was_cut_off_costs_its_batch_alone(path, cut):
    filled(path).close()
    path.write_bytes(path.read_bytes()[:-cut])
    journal = Journal(path)
    assert journal.partials["a"].samples_ms == ([1.0, 2.0, 3.0] if cut == 1 else [1.0, 2.0])
    journal.add("a", "third", [9.0], {})  # after it every line is whole again
    assert Journal(path).partials["a"].samples_ms[-1] == 9.0


@pytest.mark.parametrize("line", [
    b"[]", b"\xff", b"[" * 100_000, b'{"key": 1}', b'{"key": "a", "session": "s", "samples_ms": [null], "passes": {}}',
    b'{"key": "a", "session": "s", "samples_ms": [1], "passes": {"x": 1}}', b'{"key": "a"}'])
def test_a_line_that_is_no_batch_is_passed_over(path, line):
    filled(path).close()
    path.write_bytes(line + b"\n" + path.read_bytes())
    assert Journal(path).partials["a"].samples_ms == [1.0, 2.0, 3.0]


def test_samples_of_many_processes_stay_counted_when_lines_are_gathered(path):
    filled(path).close()
    journal = Journal(path)
    journal.add("b", "third", [8.0], {})
    found = Journal(path).partials
    assert (found["a"].sessions, found["b"].sessions) == (2, 2)
    assert found["b"].samples_ms == [7.0, 8.0]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_disk_is_one_line(path):
    journal = filled(path)
    journal._file = open("/dev/full", "wb", buffering=0)  # noqa: SIM115 - the journal closes it
    with pytest.raises(StoreError, match=r"unfinished.jsonl: cannot be written: No space left.*free some space"):
        journal.add("a", "third", [1.0], {})
