"""The table of columns: every entry has a producer and is known wherever columns are named."""

import importlib
import inspect

import pytest

from mfr_bench.config import columns as of_configs
from mfr_bench.report import data
from mfr_bench.store.columns import COLUMNS, DERIVED, PASS_COLUMNS


@pytest.mark.parametrize("table", [COLUMNS, PASS_COLUMNS, DERIVED], ids=["results", "passes", "derived"])
def test_names_are_unique_and_meanings_are_given(table):
    assert len({c.name for c in table}) == len(table)
    assert all(c.meaning for c in table)


@pytest.mark.parametrize("column", [c for c in (*COLUMNS, *DERIVED) if c.origin in ("values", "derived")],
                         ids=lambda c: c.name)
def test_the_producer_of_a_column_names_it(column):
    source = inspect.getsource(importlib.import_module(f"mfr_bench.{column.producer}"))
    assert f'"{column.name}"' in source or f"{column.name}=" in source


def test_configs_and_figures_know_the_same_measures():
    assert set(of_configs.MEASURED) | {"share"} == set(data.MEASURES)
    assert not set(of_configs.MEASURED) & set(of_configs.IDENTITY)


def test_axes_are_labelled_with_their_unit():
    assert data.MEASURES["time_ms"] == "time (ms)" and data.MEASURES["psnr_db"] == "psnr_db (dB)"
    assert data.MEASURES["memory_mib"] == "memory (MiB)" and data.MEASURES["share"] == "share of the passes' time"
