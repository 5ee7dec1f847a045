"""The Python API: data frames with units, a plot in the figures' colours, a notebook that runs, a fast import."""

import csv
import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import pytest

import mfr_bench
from mfr_bench.errors import UsageError
from mfr_bench.report.style import method_colour
from mfr_bench.store import derive
from mfr_bench.store.columns import COLUMNS, PASS_COLUMNS

from .report import planted

ROOT = Path(__file__).parents[1]
NOTEBOOK = ROOT / "examples" / "results.ipynb"
SLOW = {"numpy", "pandas", "matplotlib", "click", "pydantic", "yaml"}


@pytest.fixture
def folder(tmp_path):
    made = planted.folder(tmp_path / "planted", planted.sweep(), sweep={"k": [4, 8, 16, 32, 64]})
    derive(made)
    return made


def test_cells_are_the_rows_of_the_csv_with_units(folder):
    cells = mfr_bench.load(folder.path).cells
    with open(folder.path / "results.csv") as file:
        rows = {row["key"]: row for row in csv.DictReader(file)}
    assert set(cells.key) == set(rows) and len(cells) == len(rows)
    assert list(cells.columns)[:len(COLUMNS)] == [c.name for c in COLUMNS]
    assert cells.attrs["units"] == {c.name: c.unit for c in COLUMNS if c.unit}
    assert cells.attrs["meanings"]["time_ms"] == "whole frame, median"
    for cell in cells.itertuples():
        written = rows[cell.key]["time_ms"]
        assert (written == "") == (cell.time_ms != cell.time_ms)
        assert written == "" or float(written) == cell.time_ms
    assert cells["k"].dtype == "Int64" and cells["noisy"].dtype == "boolean"
    assert set(cells["point.k"].dropna()) == {4, 8, 16, 32, 64}


def test_passes_samples_and_manifests(folder):
    results = mfr_bench.load(folder.path)
    assert list(results.passes.columns) == [c.name for c in PASS_COLUMNS]
    assert results.passes.attrs["units"]["time_ms"] == "ms"
    measured = results.cells.dropna(subset=["time_ms"])
    assert results.samples.groupby("key").size().to_dict() == dict(zip(measured.key, measured.samples, strict=True))
    assert results.manifests["planted"]["timer"] == "wall"


@pytest.mark.parametrize(("part", "value", "said"), [
    ("seed", "two", "seed is 'two'; allowed: int"), ("fragment_probability", [None], "allowed: float")])
def test_a_value_of_another_type_is_named(tmp_path, part, value, said):
    planted.folder(tmp_path / "edited", [planted.cell("ab-array"), planted.cell("mlab", scene={part: value})])
    with pytest.raises(UsageError, match="planted: a cell of mlab: ") as error:
        mfr_bench.load(tmp_path)
    assert said in str(error.value) and len(str(error.value).splitlines()) == 1


def test_several_folders_load_as_one(folder, tmp_path):
    planted.folder(tmp_path / "other", [planted.cell(experiment="other")], name="other")
    both = mfr_bench.load(tmp_path)
    assert set(both.cells.experiment) == {"planted", "other"}
    assert len(mfr_bench.load(folder.path, tmp_path / "other").cells) == len(both.cells)


def test_what_is_not_there_is_a_usage_error(tmp_path, folder):
    with pytest.raises(UsageError):
        mfr_bench.load(tmp_path / "nothing")
    with pytest.raises(UsageError, match=r"no column 'tme_ms'; .*nearest: 'time_ms'"):
        mfr_bench.plot(mfr_bench.load(folder.path).cells, y="tme_ms")


@pytest.mark.parametrize("given", [5, None, b"results", ["results", "more"]])
def test_what_is_no_path_is_named(given):
    with pytest.raises(TypeError, match=r"^load: .* is no folder; allowed: paths as str or os\.PathLike") as error:
        mfr_bench.load(given)
    assert repr(given) in str(error.value)


@pytest.mark.parametrize(("options", "said"), [
    ({"y": "label"}, "column 'label' has no numbers; allowed: "), ({"x": "method"}, "column 'method' has no numbers; "),
    ({"log": "z"}, "log='z'; allowed: letters of 'xy'"), ({"x": "nope"}, "no column 'nope'; ")])
def test_what_cannot_be_plotted_is_one_line(folder, options, said):
    with pytest.raises(UsageError) as error:
        mfr_bench.plot(mfr_bench.load(folder.path).cells, **options)
    assert len(error.value.lines) == 1 and error.value.lines[0].startswith(f"plot: {said}")


def test_a_plot_has_a_line_for_each_label_in_its_colour(folder):
    mpl.use("agg")
    cells = mfr_bench.load(folder.path).cells
    axes = mfr_bench.plot(cells, "k", "time_ms", log="xy")
    drawn = {line.get_label(): line for line in axes.get_lines()}
    measured = cells.dropna(subset=["k", "time_ms"])
    assert set(drawn) == set(measured.label)
    for label, rows in measured.groupby("label"):
        assert list(drawn[label].get_xdata()) == sorted(rows.k)
        assert drawn[label].get_color() == method_colour(rows.method.iloc[0])
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("k (fragments)", "time_ms (ms)")
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    mpl.pyplot.close(axes.figure)


def test_the_import_loads_nothing_that_takes_time():
    code = "import sys, mfr_bench; print(*{name.partition('.')[0] for name in sys.modules})"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert not set(said.stdout.split()) & SLOW


def test_every_name_that_is_promised_is_there():
    page = (ROOT / "docs" / "api.md").read_text()
    assert all(f"`mfr_bench.{name}" in page and getattr(mfr_bench, name) for name in mfr_bench.__all__)
    with pytest.raises(AttributeError, match="no attribute 'lod'"):
        mfr_bench.lod  # noqa: B018 - it is the access that is tested


def test_the_notebook_runs_and_draws(tmp_path):
    """Executed as Jupyter does; it holds no outputs of its own."""
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(NOTEBOOK, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": NOTEBOOK.parent}}).execute()
    outputs = [output for cell in code for output in cell.outputs]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert not any(output.output_type == "error" for output in outputs)
