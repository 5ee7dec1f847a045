"""The papers' printed numbers: readable, tidy, and recomputed wherever a formula gives them."""

from __future__ import annotations

import math

import pytest

from mfr_bench import resources
from mfr_bench.errors import MfrError, StoreError
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import SceneStats, evaluate
from mfr_bench.report import reference
from mfr_bench.report.reference import find, printed

MIB = 2**20
PAPERS = {"sbuffer2012", "kplus2014", "kplus2015", "gpupro5", "occupancy2015", "twochannel"}
BOUNDS = {None, "about", "from", "to", "up to", "above", "below"}
MEMORY = find(paper="sbuffer2012", quantity="memory")


def by_formula(row) -> float:
    """MiB that the row's bytes per pixel give for its viewport, n and fragments."""
    stats = SceneStats(row.width, row.height, row.n, row.fragments, primitives=0)
    return stats.P * evaluate(row.formula, stats, {}) / MIB


def test_every_paper_is_there_and_every_row_is_its_file_s():
    for path in set(resources.reference_dir().glob("*.csv")) - {resources.reference_dir() / reference.SETTINGS}:
        assert {row.paper for row in reference._rows(path)} == {path.stem}
    assert {row.paper for row in printed()} == PAPERS


@pytest.mark.parametrize("paper", sorted(PAPERS))
def test_every_number_says_what_it_is_and_where_it_stands(paper):
    for row in find(paper=paper):
        assert row.quantity, row
        assert row.figure or row.section, row
        assert row.value is not None or row.formula, row
        assert row.value is None or math.isfinite(row.value), row
        assert row.bound in BOUNDS, row
        assert row.recomputed is None or row.note, row


def test_no_number_is_there_twice():
    assert len(set(printed())) == len(printed())


def test_methods_are_ours():
    assert {row.method for row in printed()} - {None} <= set(catalog())


@pytest.mark.parametrize("row", MEMORY, ids=lambda row: f"{row.name}-{row.width}")
def test_the_mb_table_follows_from_bytes_per_pixel(row):
    """sbuffer_2012 §4: every cell, or what stands beside it as recomputed, to the printed digits."""
    expected = row.value if row.recomputed is None else row.recomputed
    digits = 0.06 if row.recomputed else 0.006
    assert by_formula(row) == pytest.approx(expected, abs=digits)
    assert (row.recomputed is None) == (abs(by_formula(row) - row.value) < 0.06)


def test_the_mb_table_has_all_its_cells_and_its_slips():
    assert len(MEMORY) == 7 * 3
    slips = {(row.method, row.width): (row.value, row.recomputed) for row in MEMORY if row.recomputed}
    assert slips == {("ab-array", 1024): (159, 156.0), ("ab-precalc-fixed", 1024): (159, 156.0),
                     ("ab-ll", 1600): (51.7, 54.5)}
    assert all(row.note.startswith("slip: ") for row in MEMORY if row.recomputed)


def test_the_gains_of_inverse_mapping_imply_frames_shorter_than_a_pass_of_them():
    """A gain of 6 % by 0.05 ms is a frame of 0.83 ms, where the referencing alone takes 1.08 ms."""
    gains = {row.width: row.value for row in find(paper="sbuffer2012", quantity="gain_of_inverse_mapping")}
    added = {row.width: row.value for row in find(paper="sbuffer2012",
                                                  quantity="referencing_time_added_by_forward_mapping")}
    passes = {row.width: row.value for row in find(paper="sbuffer2012", quantity="referencing_time", method="ab-sb")}
    frames = {width: added[width] / (gain / 100) for width, gain in gains.items()}
    assert [round(frame, 3) for frame in frames.values()] == [0.385, 0.5, 0.833]
    assert frames[1600] < passes[1600] == 1.08
    for quantity in ("gain_of_inverse_mapping", "referencing_time_added_by_forward_mapping"):
        assert all("shorter than the printed referencing" in row.note
                   for row in find(paper="sbuffer2012", quantity=quantity))


def test_memory_of_the_a_buffer_based_k_buffers_at_k_64():
    """kplus_2015 Fig. 8 by Table 1: what needs more than 3 GB at n = 640 in every covered pixel, and what does not."""
    words = {row.method: row.formula for row in find(paper="kplus2015", quantity="words_per_pixel", condition=None)}

    def mib(method, fragments):
        stats = SceneStats(1024, 1024, 640, round(fragments * 2**20), primitives=0)
        return round(4 * evaluate(words[method], stats, {}))
    full, drawn = 0.75 * 0.75 * 640, 0.75 * 0.75 * 352
    assert [mib(m, full) for m in ("kb-ab-sb", "kb-ab-ll", "kb-ll")] == [2888, 4324, 4344]
    assert [mib(m, drawn) for m in ("kb-ab-sb", "kb-ab-ll", "kb-ll")] == [1592, 2380, 2400]


def test_s_buffer_s_memory_gives_the_fragments():
    """The fragments of the three sizes are no print: they are what S-buffer's 12 bytes per pixel leave."""
    for row in find(paper="sbuffer2012", quantity="memory", method="ab-sb"):
        left = row.value * MIB - 12 * row.width * row.height
        assert left / 8 == pytest.approx(row.fragments, abs=0.006 * MIB / 8)


def test_saved_memory_follows_from_the_table():
    table = {row.method: row.value for row in MEMORY if row.width == 640}
    for row in find(paper="sbuffer2012", quantity="memory_saved"):
        assert 100 * (1 - table[row.method] / table["ab-array"]) == pytest.approx(row.recomputed, abs=0.1)
        assert row.value == 30


def test_referencing_has_all_twelve_times():
    times = {(row.method, row.width): row.value for row in find(paper="sbuffer2012", quantity="referencing_time")}
    assert len(times) == 12
    ratios = [round(times["ab-sb", w] / times["ab-precalc-fixed", w], 1) for w in (640, 1024, 1600)]
    assert ratios == [8.0, 8.5, 9.8]
    scan = [round(times["ab-precalc", w] / times["ab-sb", w], 1) for w in (640, 1024, 1600)]
    assert scan == [7.0, 5.8, 4.5]
    for text, found in (("8.0, 8.5 and 9.8", "ab-sb"), ("7.0, 5.8 and 4.5", "ab-precalc")):
        rows = find(paper="sbuffer2012", quantity="referencing_time_ratio", method=found)
        assert rows
        assert all(text in row.note for row in rows)


def test_k_bound_of_200_mb():
    """Eq. 5 of kplus_2015 with 2k + 2 words of 4 bytes: the printed 32 does not belong to 1024 x 1024."""
    (row,) = find(paper="kplus2015", quantity="k_bound", figure="4")

    def bound(width, height):
        return int((MIB * 200 / (width * height) - 8) / 8)
    assert (bound(1024, 1024), bound(1024, 768)) == (row.recomputed, row.value) == (24, 32)


def test_table_1_agrees_with_the_slides():
    """Both print the words of each k-buffer; KB-MDT_64 came later."""
    def words(paper):
        return {(r.method, r.condition): r.formula for r in find(paper=paper, quantity="words_per_pixel")}
    newer, older = words("kplus2015"), words("kplus2014")
    assert {key: formula for key, formula in newer.items() if key in older} == older
    assert newer.keys() - older.keys() == {("kb-mdt64", None)}
    assert len(newer) == 17


def test_a_broken_file_names_its_line(tmp_path):
    path = tmp_path / "paper.csv"
    path.write_text(",".join(reference.COLUMNS) + "\n" + "paper" + "," * 14 + "three" + "," * 6 + "\n")
    with pytest.raises(StoreError, match=r"paper\.csv:2: could not convert string to float: 'three'"):
        list(reference._rows(path))
    path.write_text("paper,value\n")
    with pytest.raises(StoreError, match="columns"):
        list(reference._rows(path))


def test_an_installation_without_the_numbers_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(resources, "PACKAGE", tmp_path / "mfr_bench")
    with pytest.raises(MfrError, match="the reference of mfr-bench are missing"):
        resources.reference_dir()
