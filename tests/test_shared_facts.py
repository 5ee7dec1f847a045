"""Facts that two layers hold, because neither may import the other, are the same."""

from mfr_bench import plan, store
from mfr_bench.methods import catalog
from mfr_bench.oracle import quality
from mfr_bench.report import data


def test_the_floor_is_one_method():
    assert plan.FLOOR == store.FLOOR
    assert plan.FLOOR in catalog()


def test_exact_means_the_same_in_rows_and_tables():
    assert data.EXACT_ERROR == quality.EXACT_ERROR
