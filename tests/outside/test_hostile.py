"""Folders of methods whose name, id or answer is not what it should be."""

from __future__ import annotations

import io
import pickle

import pytest

from mfr_bench.methods.outside import Reader
from mfr_bench.methods.shared import resolve
from mfr_bench.methods.spec import Pass

from .test_outside import METHOD, folder, mfr  # noqa: F401


def naming(module, name):
    """A pickle that is what has this name in a module."""
    words = (b"\x8c" + bytes([len(text)]) + text.encode() for text in (module, name))
    return pickle.PROTO + b"\x04" + b"".join(words) + pickle.STACK_GLOBAL + pickle.STOP


@pytest.mark.parametrize(("module", "name"), [
    ("mfr_bench.methods.outside", "subprocess.run"), ("mfr_bench.methods.outside", "os.system"),
    ("mfr_bench.methods.outside", "TemporaryFile"), ("mfr_bench.methods.outside", "entry_points"),
    ("mfr_bench.methods.outside", "tempfile"), ("os", "system"), ("builtins", "eval")])
def test_an_answer_names_nothing_but_the_words_of_declarations(module, name):
    with pytest.raises((pickle.UnpicklingError, AttributeError)):
        Reader(io.BytesIO(naming(module, name))).load()


@pytest.mark.parametrize("word", [Pass, resolve])
def test_the_words_of_declarations_are_read(word):
    assert Reader(io.BytesIO(pickle.dumps(word))).load() is word


def test_a_folder_that_the_variable_cannot_hold_is_one_line(tmp_path, folder):  # noqa: F811
    folder.rename(tmp_path / "a:b")
    done = mfr(tmp_path, "methods", "--methods", "a:b")
    assert done.returncode == 2 and done.stderr.startswith("--methods a:b: its path has a ':'")
    assert done.stderr.count("\n") == 1 and not done.stdout


def test_check_never_takes_the_program_s_own_method_for_one_of_its_id(folder):  # noqa: F811
    declared = folder / METHOD
    declared.write_text(declared.read_text().replace('id="my-array"', 'id="ab-array"'))
    done = mfr(folder, "check", "ab-array", "--methods", ".", "--no-race")
    assert done.returncode == 2 and not done.stdout
    assert "NAME: 'ab-array' would be another method than the one from outside" in done.stderr


def test_an_empty_name_is_no_method(tmp_path):
    done = mfr(tmp_path, "new-method", "")
    assert done.returncode == 2 and "'' is no name of a method" in done.stderr


def test_a_new_method_has_an_id_of_its_own(tmp_path):
    done = mfr(tmp_path, "new-method", "ab-array", "--out", "new")
    assert done.returncode == 2 and "'ab-array' is a method already" in done.stderr and not (tmp_path / "new").exists()
