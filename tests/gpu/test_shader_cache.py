"""Mesa's cache of programs is left alone where its file system has no room."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from mfr_bench.gpu import shader_cache
from mfr_bench.gpu.egl import egl_devices
from mfr_bench.gpu.shader_cache import OFF, VARIABLE, avoid_full_cache, cache_folder, has_room


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder of Mesa's cache, without its variable that turns the cache off."""
    monkeypatch.setenv("MESA_SHADER_CACHE_DIR", str(tmp_path / "not" / "there"))
    monkeypatch.setenv(VARIABLE, "")  # so that the test's own change is undone
    monkeypatch.delenv(VARIABLE)
    return tmp_path


def fails_with(number: int):
    def failing(*_given: object) -> None:
        raise OSError(number, os.strerror(number))
    return failing


@pytest.mark.parametrize(("number", "chosen"), [
    (errno.ENOSPC, OFF), (errno.EDQUOT, OFF), (errno.EROFS, None), (errno.EACCES, None)])
def test_the_cache_is_off_where_its_blocks_cannot_be_had(folder, monkeypatch, number, chosen):
    monkeypatch.setattr(shader_cache.os, "posix_fallocate", fails_with(number))
    egl_devices()
    assert os.environ.get(VARIABLE) == chosen


def test_the_cache_stays_where_there_is_room(folder):
    avoid_full_cache()
    assert VARIABLE not in os.environ
    assert list(folder.iterdir()) == []


def test_what_the_user_has_chosen_stays(folder, monkeypatch):
    monkeypatch.setattr(shader_cache.os, "posix_fallocate", fails_with(errno.ENOSPC))
    monkeypatch.setenv(VARIABLE, "false")
    avoid_full_cache()
    assert os.environ[VARIABLE] == "false"


def test_a_path_through_a_file_is_as_good_as_any(folder):
    (folder / "file").touch()
    assert has_room(folder / "file" / "below")


@pytest.mark.parametrize(("variables", "expected"), [
    ({"MESA_SHADER_CACHE_DIR": "/a", "XDG_CACHE_HOME": "/b"}, "/a"),
    ({"MESA_SHADER_CACHE_DIR": "", "XDG_CACHE_HOME": "/b"}, "/b"), ({}, "/home/one/.cache")])
def test_the_folder_is_the_one_that_mesa_takes(monkeypatch, variables, expected):
    for name in ("MESA_SHADER_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(shader_cache.pwd, "getpwuid", lambda _: type("Entry", (), {"pw_dir": "/home/one"}))
    assert cache_folder() == Path(expected)
