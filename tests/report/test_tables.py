"""Tables by what they say."""

from __future__ import annotations

import csv
import math

import pytest

from mfr_bench.report import data, tables
from mfr_bench.report.tables.grid import Grid

from . import planted
from .planted import cell

FIGURE = {"kind": "stacked_passes", "x": "k", "y": "time_ms"}


def at(k, method="kplus-array", label="K⁺B-Array", time_ms=5.0, **parts):
    return cell(method, label, time_ms, params={"k": k}, point={"k": k}, **parts)


def section(text, title):
    """The lines of one titled part of a terminal table."""
    parts = [part for part in text.split("\n\n") if part.startswith(title)]
    assert len(parts) == 1, text
    return parts[0].splitlines()


def fields(lines, name):
    return next(line for line in lines if line.startswith(name))[len(name):].split("  ")


def words(lines, name):
    return [field.strip() for field in fields(lines, name) if field.strip()]


def test_time_has_its_interval_and_columns_are_the_sweep(tmp_path):
    folder = planted.folder(tmp_path, [at(4, time_ms=5.0), at(16, time_ms=20.0, width=0.09, values={"noisy": True})],
                            [FIGURE])
    lines = section(tables.terminal_table(folder), "Time, ms")
    assert words(lines, "method") == ["k = 4", "k = 16"]
    assert words(lines, "K⁺B-Array") == ["5.00 ±0.6 %", "20.0 ±5.7 % ~"]


def test_the_ratio_is_to_the_floor_of_the_same_scene(tmp_path):
    other = {"depth_complexity": 64}
    folder = planted.folder(tmp_path, [
        cell("floor", "floor", 2.0), at(4, time_ms=5.0), cell("floor", "floor", 4.0, scene=other,
                                                              point={"scene.depth_complexity": 64}),
        cell("kplus-array", "K⁺B-Array", 5.0, scene=other, params={"k": 4},
             point={"k": 4, "scene.depth_complexity": 64})])
    lines = section(tables.terminal_table(folder), "Ratio to the floor")
    assert [w.split()[0] for w in words(lines, "K⁺B-Array")] == ["2.50", "1.25"]


@pytest.mark.parametrize(("time_ms", "noise", "said"), [
    (4.0, 0.0, "2.00 ±"), (2.2, 0.05, "1.10 ±"), (2.2, 0.2, "≈ 1.10 ["), (2.01, 0.0, "≈ 1.01 [1.00, 1.01]"),
    (1.0, 0.2, "0.500 ±")])
def test_no_ratio_below_the_noise_is_called_real(tmp_path, time_ms, noise, said):
    """Neither one whose interval holds 1, nor one that is smaller than what one method measured twice differs by."""
    folder = planted.folder(tmp_path, [cell("floor", "floor", 2.0), at(4, time_ms=time_ms)], [FIGURE],
                            noise_floor_rel=noise)
    assert words(section(tables.terminal_table(folder), "Measured"), "K⁺B-Array")[1].startswith(said)


def test_the_fastest_is_told_from_the_others_only_beyond_the_noise(tmp_path):
    rows = {"A": 5.0, "B": 5.1, "C": 10.0}
    cells = [cell(name.lower(), name, ms) for name, ms in rows.items()]
    cells += [cell("floor", "floor", 1.0), cell("k", "K", 2.0, values={"rmse": 0.1})]  # K does not show every fragment
    folder = planted.folder(tmp_path, cells, noise_floor_rel=0.03)
    lines = section(tables.terminal_table(folder), "Measured")
    assert words(lines, "method").index("Ratio to the fastest") == 2
    assert [words(lines, name)[2].split()[0] for name in rows] == ["fastest", "≈", "2.00"]
    assert "fastest" not in " ".join(words(lines, "K"))


def test_a_parameter_named_like_a_key_of_the_scene_is_no_axis(tmp_path):
    """Adaptive stood in a column of its own on every mesh, without a ratio to the fastest."""
    scene = {"kind": "mesh", "opaque": "depth"}
    cells = [cell("floor", "floor", 1.0, scene=scene), cell("ab-array", "AB_Array", 6.0, scene=scene),
             cell("adaptive", "Adaptive", 3.0, scene=scene, params={"opaque": "tested"})]
    folder = planted.folder(tmp_path, cells)
    assert data.load(folder).axes == []
    lines = section(tables.terminal_table(folder), "Measured, the fastest first")
    assert words(lines, "Adaptive")[2] == "fastest" and words(lines, "AB_Array")[2].startswith("2.00 ")


def test_a_key_of_the_scene_named_like_a_parameter_is_an_axis_where_it_differs(tmp_path):
    cells = [cell("adaptive", "Adaptive", ms, scene={"kind": "mesh", "opaque": opaque}, params={"opaque": "tested"})
             for opaque, ms in (("depth", 3.0), ("store", 6.0))]
    folder = planted.folder(tmp_path, cells)
    assert data.load(folder).axes == ["scene.opaque"]
    lines = section(tables.terminal_table(folder), "Time, ms")
    assert words(lines, "method") == ["opaque = depth", "opaque = store"]
    assert words(lines, "Adaptive") == ["3.00 ±0.6 %", "6.00 ±0.6 %"]


def test_a_stalled_frame_hides_no_method_four_times_slower(tmp_path):
    """7 samples against 49: among the first 7 of the fast method one was stalled, and its interval then reached 1."""
    fast, slow = planted.cell("fast", "Fast"), planted.cell("slow", "Slow")
    fast["samples_ms"] = [1.0, 1.01, 0.99, 5.0, 1.0, 1.02, 0.98] + [1.0, 1.01, 0.99] * 14
    slow["samples_ms"] = [4.0, 4.04, 3.96, 4.1, 4.2, 3.9, 4.0]
    fast["values"] |= {"time_ms": 1.0, "time_ms_low": 0.99, "time_ms_high": 1.01}
    slow["values"] |= {"time_ms": 4.0, "time_ms_low": 3.9, "time_ms_high": 4.2}
    cells = [fast, slow, planted.cell("floor", "floor", 1.0)]
    folder = planted.folder(tmp_path, cells, noise_floor_rel=0.03)
    assert words(section(tables.terminal_table(folder), "Measured"), "Slow")[2].split()[0] == "4.00"


def test_memory_stands_beside_the_papers_model(tmp_path):
    folder = planted.folder(tmp_path, [at(4, values={"memory_bytes": 3 * 2**20, "memory_model_bytes": 2 * 2**20}),
                                       at(8)], [FIGURE])
    assert words(section(tables.terminal_table(folder), "Memory, MiB"), "K⁺B-Array") == ["3.00 / 2.00", "1.00 / 1.00"]


@pytest.mark.parametrize(("errors", "said"), [
    ((1e-7, 1e-4), "exact"), ((1e-7, 1.1e-4), "exact in 1 of 2"), ((0.5, 0.2), "differs"),
    ((None, None), "not checked"), ((1e-7, None), "exact")])
def test_images_say_which_methods_were_exact(tmp_path, errors, said):
    folder = planted.folder(tmp_path, [at(k, values={"max_abs_error": e}) for k, e in zip((4, 8), errors, strict=True)])
    assert words(section(tables.terminal_table(folder), "Images"), "K⁺B-Array")[2] == said


@pytest.mark.parametrize(("promised", "kept", "worst", "said"), [
    (0.25, 0.25, 0.3, "as promised"), (None, 0.25, 0.3, "as promised"), (0.25, 0.25, 5e-5, "exact"),
    (1.0, 1.0, 1e-7, "exact"), (None, None, None, "exact")])
def test_an_image_of_fewer_fragments_is_called_exact_only_where_it_shows_what_all_give(tmp_path, promised, kept, worst,
                                                                                      said):
    """The Z-buffer, which keeps one fragment of a pixel, was called exact."""
    values = {"max_abs_error": 1e-7, "promised_ratio": promised, "hit_ratio": kept, "max_error_all": worst}
    folder = planted.folder(tmp_path, [at(4, values=values)])
    assert words(section(tables.terminal_table(folder), "Images"), "K⁺B-Array")[2] == said


def test_a_method_that_loses_equal_depths_is_as_promised_and_the_reason_is_told(tmp_path):
    """It was called exact here, and an error above the bound by `decide`."""
    lost = {"max_abs_error": 1e-7, "tied_pixels": 3, "tied_error": 0.3, "promised_ratio": 1.0}
    folder = planted.folder(tmp_path, [at(4, values=lost), cell("ab-array", "AB", 5.0, params={"k": 4}, point={"k": 4},
                                                                values=lost | {"tied_error": 1e-7})])
    lines = section(tables.terminal_table(folder), "Images")
    assert words(lines, "K⁺B-Array")[2] == "as promised" and words(lines, "AB")[2] == "exact"
    assert ("for equal depths that meet by chance: K⁺B-Array (of fragments of equal depth it keeps one)"
            in " ".join(lines))


@pytest.mark.parametrize("width", [0.01, 0.9])
def test_the_floor_over_itself_is_1_however_much_its_times_scatter(tmp_path, width):
    folder = planted.folder(tmp_path, [cell("floor", "floor", 2.0, width=width), at(4, time_ms=5.0)], [FIGURE])
    assert words(section(tables.terminal_table(folder), "Measured"), "floor")[1] == "1"
    assert data.load(folder).points[0].floor_ratio == (1.0, 1.0, 1.0)


def test_cells_that_the_time_budget_left_out_are_said_to_be(tmp_path):
    folder = planted.folder(tmp_path, [at(4)])
    manifest = folder.manifest()
    folder.write_manifest(manifest | {"cells": [*manifest["cells"], "one", "two"], "left_out": {"K⁺B-Array": 2}})
    said = "2 planned cells have no record yet, left out for the time budget; run the same command again"
    assert said in tables.terminal_table(folder)
    folder.write_manifest(manifest | {"cells": [*manifest["cells"], "one", "two"], "left_out": {}})
    assert "2 planned cells have no record yet; run the same command again" in tables.terminal_table(folder)


def test_cells_that_nothing_can_measure_are_no_lack_of_time(tmp_path):
    folder = planted.folder(tmp_path, [at(4)])
    manifest = folder.manifest()
    folder.write_manifest(manifest | {"cells": [*manifest["cells"], "one", "two", "three"], "refused": 1,
                                      "left_out": {"K⁺B-Array": 2}})
    said = " ".join(tables.terminal_table(folder).split())
    assert ("3 planned cells have no record yet, left out for the time budget; 1 of them cannot be measured here at "
            "all; run the same command again") in said


BREAKING = {"kind": "breaking", "x": "k"}


@pytest.mark.parametrize("text", [tables.terminal_table, tables.breaking_text,
                                  lambda folder: tables.markdown(data.load(folder))])
def test_of_results_without_a_cell_nothing_is_told_but_their_name_and_what_lacks(tmp_path, text):
    """Device, scene and headers stood there again for each of fourteen stressors of which nothing was measured."""
    folder = planted.folder(tmp_path, [], [BREAKING])
    folder.write_manifest(folder.manifest() | {"title": "Nothing", "cells": ["one", "two"]})
    found = text(folder)
    assert "Nothing" in found.splitlines()[0] and "2 planned cells have no record yet" in found
    assert "timer" not in found and "First level" not in found and "---" not in found


def test_a_stressor_without_a_method_says_so(tmp_path):
    folder = planted.folder(tmp_path, [cell("floor", "floor", 2.0, point={"k": 4})], [BREAKING])
    assert tables.breaking_text(folder).endswith(
        "First level of k that breaks each method\nNo method but the floor has a cell at any of its levels.\n")


@pytest.mark.parametrize("width", [20, 120])
def test_a_table_without_rows_is_a_word(width):
    """Its header alone was printed, once for each group of columns that fits."""
    empty = Grid("title", "", ("a long name of a column",) * 8, ())
    for laid_out in (Grid.text, Grid.markdown):
        assert [laid_out(chunk) for chunk in empty.chunks(width)] == ["None."]


def test_a_wrong_image_is_said_and_its_time_is_not(tmp_path):
    folder = planted.folder(tmp_path, [at(4), at(8, status="wrong", reason="max_abs_error 0.5 exceeds 0.0001",
                                                 values={"max_abs_error": 0.5})], [FIGURE])
    text = tables.terminal_table(folder)
    assert "WRONG in 1 of 2" in words(section(text, "Images"), "K⁺B-Array")
    assert words(section(text, "Time, ms"), "K⁺B-Array")[1] == "wrong image"
    assert "- K⁺B-Array at k = 8: wrong image: max_abs_error 0.5 exceeds 0.0001" in text


def test_skipped_cells_are_listed_with_their_reasons(tmp_path):
    reason = "needs 4112.0 MiB, the budget is 3072.0 MiB"
    folder = planted.folder(tmp_path, [
        at(4), at(8), *(at(k, "kb-mdt64", "KB-MDT₆₄", None, status="unsupported", reason="needs int64")
                        for k in (4, 8)),
        *(at(k, "atomic", "64-bit", None, status="unsupported", reason="needs int64") for k in (4, 8)),
        at(4, "kb-ll", "KB-LL"), at(8, "kb-ll", "KB-LL", None, status="over_budget", reason=reason)], [FIGURE])
    lines = section(tables.terminal_table(folder), "Not ok, or not measured")
    assert lines[1:] == ["- KB-MDT₆₄, 64-bit, every cell: unsupported: needs int64",
                         f"- KB-LL at k = 8: over budget: {reason}"]


def test_planned_cells_without_a_record_are_counted_and_dashed(tmp_path):
    cells = [at(4), at(8), at(4, "kb", "KB"), at(8, "kb", "KB")]
    folder = planted.folder(tmp_path, cells, [FIGURE])
    (folder.cells_path / f"{cells[3]['key']}.json").unlink()
    text = tables.terminal_table(folder)
    assert "1 planned cell has no record yet" in text
    assert words(section(text, "Time, ms"), "KB ")[1] == "–"


def test_damaged_files_are_named(tmp_path):
    folder = planted.folder(tmp_path, [at(4)])
    (folder.cells_path / f"{'0' * 20}.json").write_text("{")
    assert f"{'0' * 20}.json" in " ".join(section(tables.terminal_table(folder), "Files not used"))


def test_other_scene_axes_make_blocks_and_parameters_make_labels(tmp_path):
    cells = [cell("kb", "KB", 3.0, params={"k": k, "culling": c}, scene={"pixel_density": d},
                  point={"k": k, "culling": c, "scene.pixel_density": d})
             for d in (0.25, 0.75) for c in ("on", "off") for k in (4, 8)]
    text = tables.terminal_table(planted.folder(tmp_path, cells, [FIGURE]))
    for density in ("0.25", "0.75"):
        lines = section(text, f"Time, ms (p_d = {density})")
        assert len(words(lines, "KB, culling on")) == len(words(lines, "KB, culling off")) == 2


def test_entries_that_share_a_label_are_told_apart(tmp_path):
    cells = [cell("kb", "KB", 3.0, params={"k": 4, "culling": c}) for c in ("on", "off")]
    result = data.load(planted.folder(tmp_path, cells))
    assert result.labels == ["KB (culling on)", "KB (culling off)"]


def test_a_parameter_that_follows_from_the_point_tells_nothing_apart(tmp_path):
    """One entry whose passes keep 8 fragments, and only act where k is more."""
    cells = [cell("kb", "KB", 3.0, params={"k": k, "per_pass": 8 if k > 8 else 0}, point={"k": k}) for k in (4, 16)]
    assert data.load(planted.folder(tmp_path, cells)).labels == ["KB"]


def test_a_planned_record_replaces_an_older_one_of_the_same_point(tmp_path):
    old, new = at(4, time_ms=9.0, glsl_hash="old"), at(4, time_ms=5.0)
    folder = planted.folder(tmp_path, [new])
    folder.write_cell(old)
    assert [p.row["time_ms"] for p in data.load(folder).points] == [pytest.approx(5.0)]


def test_two_devices_in_one_folder_are_two_blocks(tmp_path):
    cells = [at(4), at(8), *(at(k, time_ms=1.0, device={"slug": "h200"}) for k in (4, 8))]
    text = tables.terminal_table(planted.folder(tmp_path, cells, [FIGURE]))
    assert words(section(text, "Time, ms (device = h200)"), "K⁺B-Array") == ["1.00 ±0.6 %"] * 2


@pytest.mark.parametrize("ks", [(4, 8, 16, 32, 64), tuple(range(1, 40))])
def test_lines_fit_a_terminal_and_no_column_is_lost(tmp_path, ks):
    folder = planted.folder(tmp_path, planted.sweep(ks, planted.METHODS[7:10]), [FIGURE])
    text = tables.terminal_table(folder)
    assert max(map(len, text.splitlines())) <= tables.WIDTH
    for k in ks:
        assert f"k = {k} " in text or f"k = {k}\n" in text


def test_an_interval_wider_than_the_time_is_called_noisy_and_the_note_says_what_to_do(tmp_path):
    def told(name, high_ms):
        cells = [cell("ab-ll", "AB_LL", 4.0),
                 cell("ab-sb", "AB_SB", 5.0, values={"time_ms_low": 4.0, "time_ms_high": high_ms})]
        return " ".join(tables.markdown(data.load(planted.folder(tmp_path / name, cells))).split())

    said = told("noisy", 40.0)
    assert "| 5.00 noisy |" in said and "700 %" not in said
    assert said.count("noisy: uncertain by more than the value itself") == 1  # times and ratios share the note
    assert "run --force while the machine does nothing else" in said
    said = told("calm", 10.0)
    assert "5.00 ±100 %" in said and "noisy" not in said


def test_markdown_has_the_passes_and_escapes_bars(tmp_path):
    folder = planted.folder(tmp_path, [at(4, label="a|b", passes={"clear": 1.0, "store": 3.0})], [FIGURE])
    path = tables.write_tables(folder)[0]
    text = path.read_text(encoding="utf-8")
    assert path.name == "results.md" and text.startswith("# planted: Planted results\n")
    assert "| a\\|b · store  | 3.00 |" in text
    widths = {len(line) for line in text.split("## Pass times")[1].splitlines() if line.startswith("|")}
    assert len(widths) == 1


def test_csv_files_hold_full_numbers(tmp_path):
    folder = planted.folder(tmp_path, [cell("floor", "floor", 3.0), at(4, time_ms=1.0, passes={"store": 1.5}), at(8),
                                       at(16, time_ms=None, status="crashed", reason="lost, badly")])
    for path in tables.write_tables(folder)[1:]:
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        by_k = {row["k"]: row for row in rows}
        if path.name == "summary.csv":
            assert float(by_k["4"]["floor_ratio"]) == pytest.approx(1 / 3) and by_k["4"]["exact"] == "true"
            assert by_k["16"]["reason"] == "lost, badly" and by_k["16"]["time_ms"] == by_k["16"]["exact"] == ""
        else:
            assert list(by_k) == ["4"] and float(by_k["4"]["store"]) == pytest.approx(1.5)


def test_an_empty_folder_has_a_table(tmp_path):
    assert tables.terminal_table(planted.folder(tmp_path, [])).startswith("planted")
    assert tables.terminal_table(planted.store.ResultFolder(tmp_path / "absent")).startswith("absent")


@pytest.mark.parametrize(("value", "text"), [
    (None, ""), (0.0, "0"), (5.0, "5.00"), (12.345, "12.3"), (99.96, "100"), (1234.4, "1234"), (0.01234, "0.0123"),
    (1e-6, "1e-06"), (123456789.0, "1.23e+08"), (7, "7"), (math.inf, "inf")])
def test_numbers_have_three_digits(value, text):
    assert data.number(value) == text


@pytest.mark.parametrize(("noise", "text"), [(0.025, "2.5 %"), (2.1, "210 %"), (144757.05, "above 1000 %")])
def test_a_noise_floor_has_no_digits_where_they_tell_nothing(noise, text):
    assert tables.noise_text(noise) == text


def test_a_scene_that_follows_a_parameter_loses_no_column(tmp_path):
    """r = 1 gives n = k; a method without k is still measured at each n."""
    cells = [made for n in (8, 16) for made in (
        cell("ab-ll", "AB_LL", n / 2, scene={"depth_complexity": n}),
        cell("kplus-array", "K⁺B-Array", n / 4, scene={"depth_complexity": n}, params={"k": n}, point={"k": n}))]
    figure = {"kind": "lines", "x": "depth_complexity", "y": "time_ms"}
    for figures, title in (([figure], "Time, ms"), ([], "Time, ms (n = 16)")):
        text = tables.terminal_table(planted.folder(tmp_path / title, cells, figures, {"k": [8, 16]}))
        assert words(section(text, title), "AB_LL")[-1].startswith("8.00")


# --- the paper's numbers ---------------------------------------------------------------------------


def printed_lines(tmp_path, cells, **source):
    text = tables.terminal_table(planted.folder(tmp_path, cells, [FIGURE], source=source))
    return section(text, "The paper's numbers")


def test_printed_numbers_stand_beside_the_measured_ones(tmp_path):
    cells = [cell("ab-sb", "AB_SB", 3.0, scene={"size": [80, 60], "pixel_density": 0.45},
                  values={"memory_bytes": 2**18}), cell("kb", "KB", 3.0, scene={"size": [80, 60]})]
    lines = printed_lines(tmp_path, cells, paper="sbuffer2012", figure="§4", prints=["memory"])
    sb = next(line for line in lines if line.startswith("memory · S-buffer · 640×480"))
    assert sb.split()[-7:] == ["6.99", "MB", "0.250", "at", "80×60", "GTX", "480"]
    slip = next(line for line in lines if line.startswith("memory · Linked Lists · 1600×1200"))
    assert "51.7 MB (slip: 54.5 follows)" in slip and " – " in slip


def test_a_formula_is_printed_as_such_and_variants_have_nothing_beside_them(tmp_path):
    cells = [cell("kb", "KB", 3.0, params={"k": 8}, values={"memory_bytes": 64 * 64 * 64})]
    lines = printed_lines(tmp_path, cells, paper="kplus2015", figure="Table 1", prints=["words_per_pixel"])
    assert words(lines, "words per pixel · KB ")[-1] == "16.0"
    assert words(lines, "words per pixel · KB · attribute packing")[-1] == "–"


def test_numbers_of_other_figures_are_left_out(tmp_path):
    """Speed-ups are printed for Fig. 6, for Fig. 9 and in the text: each stands with its own."""
    found = {figure: len(printed_lines(tmp_path / figure[:1], [at(4)], paper="kplus2015", figure=figure,
                                       prints=["speedup"])) for figure in ("6", "9 (left)", "§5.1.2")}
    assert len(set(found.values())) == 1
    nothing = tables.terminal_table(planted.folder(tmp_path / "none", [at(4)], [FIGURE], source={"paper": "kplus2015"}))
    assert "The paper's numbers" not in nothing


def test_a_label_of_two_lines_is_one_field_of_a_table():
    grid = Grid("", "", ("method", "a\nb"), (("x|y\nz", "1"),))
    assert grid.markdown().splitlines() == ["| method | a b |", "|:-------|----:|", "| x\\|y z |   1 |"]
    assert grid.text().splitlines() == ["method   a b", "------------", "x|y z      1"]


def test_one_scene_is_ranked_by_time(tmp_path):
    cells = [cell("ab-ll", "Slow", 3.0), cell("kb", "Out", None, status="unsupported", reason="needs x"),
             cell("ab-array", "Fast", 1.0), cell("floor", "Blending floor", 2.0)]
    lines = section(tables.terminal_table(planted.folder(tmp_path, cells)), "Measured, the fastest first")
    names = [line.split("  ")[0] for line in lines if line.startswith(("Slow", "Fast", "Blending"))]
    assert names == ["Blending floor", "Fast", "Slow"]
