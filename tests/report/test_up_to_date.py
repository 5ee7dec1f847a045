"""A figure is drawn again when anything changed that it is drawn from, and only then."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner

from mfr_bench import store
from mfr_bench.cli.main import cli
from mfr_bench.report import data, figures, style, tables
from mfr_bench.report.figures import files, inputs
from mfr_bench.report.figures.files import write_all
from mfr_bench.report.reference import Printed
from mfr_bench.store.arrays import write_arrays

from . import planted
from .drawing import FRAMES, KINDS, MAPS, STACKED, WORK, keep_arrays, mapped, two_methods

EVERY_KIND = [*KINDS, MAPS, {"kind": "histogram", "x": "k"}, {"kind": "pareto", "x": "time_ms", "y": "rmse"},
              {"kind": "heat", "x": "k", "y": "best_ratio", "rows": "n"}, {"kind": "work", "x": "k", "y": "time_ms"},
              {"kind": "breaking", "x": "k"}]


def of_every_kind(path):
    """A folder with something to draw for each kind of figure."""
    return keep_arrays(planted.folder(path, two_methods(frames=FRAMES, work=WORK), EVERY_KIND), error=np.zeros((4, 4)))


def drawn(folder, **how):
    """How many figures of a folder are drawn, by a reader that knows nothing of it yet."""
    found, = write_all([store.ResultFolder(folder.path)], **how)
    return len(found.paths) // 2 - found.kept


@pytest.fixture
def folder(tmp_path):
    made = planted.folder(tmp_path / "set", two_methods(), [STACKED, KINDS[2]])
    assert drawn(made) == 2
    return made


def test_what_is_up_to_date_is_left_as_it_is(folder):
    before = {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in (folder.path / "figures").iterdir()}
    assert drawn(folder) == 0
    assert {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in before} == before
    assert drawn(folder, force=True) == 2
    assert {path: path.read_bytes() for path in before} == {path: content for path, (_, content) in before.items()}


def test_a_changed_record_or_manifest_is_drawn(folder):
    cell = folder.cells()[0]
    folder.write_cell(cell | {"values": cell["values"] | {"memory_bytes": 12345}})
    assert drawn(folder) == 2
    folder.write_manifest(folder.manifest() | {"title": "Another title"})
    assert drawn(folder) == 2
    folder.write_manifest(folder.manifest() | {"figures": [STACKED | {"log": ""}, KINDS[2]]})
    assert drawn(folder) == 1
    (folder.cells_path / f"{cell['key']}.json").unlink()
    assert drawn(folder) == 2 and drawn(folder) == 0


@pytest.mark.parametrize(("place", "name", "found"), [
    (inputs, "_code", "other code"), (inputs, "_libraries", ["matplotlib 99"]),
    (style, "method_colours", {"kb-ps": "#123456"}), (inputs, "tie_losers", frozenset({"kb-ps"}))])
def test_other_code_libraries_or_methods_draw_anew(folder, monkeypatch, place, name, found):
    monkeypatch.setattr(place, name, lambda: found)
    assert drawn(folder) == 2


def test_other_printed_numbers_draw_anew(folder, monkeypatch):
    row = Printed(**(dict.fromkeys(Printed.__dataclass_fields__) | {"paper": "kplus2015", "quantity": "k"}))
    monkeypatch.setattr(inputs.printed, "rows", lambda result: [row])
    assert drawn(folder) == 2


def middle_gone(content):
    return content[:len(content) // 2] + content[len(content) // 2 + 999:]


def one_bit_flipped(content):
    return content[:-3000] + bytes([content[-3000] ^ 1]) + content[-2999:]


def middle_zeros(content):
    """What a loss of power may leave of a file."""
    return content[:4096] + bytes(len(content) - 5120) + content[-1024:]


@pytest.mark.parametrize("spoilt", [lambda content: content[:-9], lambda content: b"", lambda content: content + b"x",
                                    lambda content: content[:2048], middle_gone, one_bit_flipped, middle_zeros],
                         ids=["end gone", "empty", "more", "head only", "middle gone", "bit flipped", "zeros"])
@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_a_damaged_file_is_drawn_anew(folder, spoilt, suffix):
    path = folder.path / "figures" / f"planted-1.{suffix}"
    whole = path.read_bytes()
    path.write_bytes(spoilt(whole))
    assert drawn(folder) == 1 and drawn(folder) == 0 and path.read_bytes() == whole


@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_a_file_that_is_gone_is_drawn_anew(folder, suffix):
    (folder.path / "figures" / f"planted-1.{suffix}").unlink()
    assert drawn(folder) == 1 and drawn(folder) == 0


def test_what_an_interrupted_plot_has_not_drawn_is_drawn_by_the_next(folder, monkeypatch):
    for path in (folder.path / "figures").iterdir():
        path.unlink()
    figures_drawn, render = [], files.render

    def interrupted(*given):
        figures_drawn.append(given)
        if len(figures_drawn) == 2:
            raise KeyboardInterrupt
        return render(*given)

    monkeypatch.setattr(files, "render", interrupted)
    with pytest.raises(KeyboardInterrupt):
        drawn(folder, processes=1)
    monkeypatch.undo()
    assert sorted(path.name for path in (folder.path / "figures").iterdir()) == ["planted-1.png", "planted-1.svg"]
    assert drawn(folder) == 1 and drawn(folder) == 0


KILLED = """
import os, signal, sys
from pathlib import Path
from mfr_bench.store import write_file
os.replace = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
write_file(Path(sys.argv[1]), b"half")
"""


@pytest.mark.parametrize("place", ["figures/planted-1.png", "tables/results.md", "cells/0.json", "manifest.json"])
def test_what_a_killed_process_left_half_written_is_removed_by_the_next(folder, place):
    path = folder.path / place
    subprocess.run([sys.executable, "-c", KILLED, str(path)], check=False)
    left, = path.parent.glob(".*.part")
    of_another_machine = left.with_name(left.name.replace(store.files.HOST, "elsewhere"))
    of_one_at_work = left.with_name(left.name.replace(left.name.split(".")[-2], str(os.getppid())))
    for other in (of_another_machine, of_one_at_work):
        other.write_bytes(b"half")
    assert drawn(folder) == 0
    tables.write_tables(folder)
    with folder.lock():
        pass
    assert set(path.parent.glob(".*.part")) == {of_another_machine, of_one_at_work}


def test_another_array_is_drawn_where_arrays_are(tmp_path):
    arrays = {("KB", 8): {"error": np.ones((4, 4))}}
    mapped(tmp_path, MAPS, arrays)
    folder = store.ResultFolder(tmp_path)
    assert drawn(folder) == 1 and drawn(folder) == 0
    write_arrays(folder, folder.cells()[0]["key"], {"error": np.zeros((4, 4))})
    assert drawn(folder) == 1


def test_packing_changes_nothing_that_is_drawn(folder):
    folder.pack()
    assert drawn(folder) == 0


def test_what_a_run_writes_of_its_own_time_changes_nothing(folder):
    folder.write_manifest(folder.manifest() | {"split_s": {"plan": 1.0}})
    assert drawn(folder) == 0


def test_no_figure_reads_what_its_mark_leaves_out(tmp_path):
    """Marks leave out the parts of a manifest that a run writes of itself."""
    read = set()

    class Told(dict):
        def __getitem__(self, name):
            read.add(name)
            return super().__getitem__(name)

        def get(self, name, default=None):
            read.add(name)
            return super().get(name, default)

    folder = of_every_kind(tmp_path)
    manifest = folder.manifest()
    folder.manifest = lambda: Told(manifest)
    result = data.load(folder)
    for options in EVERY_KIND:
        figures.render(figures.build(result, options))
    assert {"title", "device"} <= read and not read & set(inputs.UNSEEN)


def test_the_mark_covers_all_code_that_draws(tmp_path):
    of_every_kind(tmp_path)
    code = ("import sys, json; from mfr_bench import store; from mfr_bench.report import write_figures; "
            f"write_figures(store.ResultFolder({str(tmp_path)!r})); "
            "print(json.dumps([m.__file__ for n, m in sys.modules.items() if n.partition('.')[0] == 'mfr_bench']))")
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    covered = [inputs.PACKAGE / place for place in inputs.CODE]
    families = inputs.PACKAGE / "methods"  # their declarations: the catalog's part in a figure stands in the mark
    loaded = {inputs.PACKAGE / path for path in json.loads(done.stdout)}
    assert not [path for path in loaded if path.parent != families and not {path, *path.parents} & set(covered)]
    assert all(path.exists() for path in covered)


def test_what_could_not_be_used_is_told_each_time(folder):
    (folder.cells_path / "no cell.json").write_text("{}")
    assert drawn(folder) == drawn(folder) == 2


def test_several_folders_share_their_work_and_keep_their_order(tmp_path):
    folders = [planted.folder(tmp_path / name, two_methods(), [STACKED], name=name) for name in "abcd"]
    assert [drawn(folder) for folder in folders[1:3]] == [1, 1]
    found = list(write_all(folders, processes=2))
    assert [each.paths[0].stem for each in found] == list("abcd") and [each.kept for each in found] == [0, 1, 1, 0]


def test_the_command_says_how_many_were_up_to_date(folder):
    done = CliRunner().invoke(cli, ["plot", str(folder.path)])
    assert done.exit_code == 0 and "2 figures were up to date; --force draws all again" in done.stderr
    assert "up to date" not in CliRunner().invoke(cli, ["plot", str(folder.path), "--force"]).stderr
