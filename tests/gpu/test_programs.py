"""Linked programs are kept while they are in use or were used of late, and deleted otherwise."""

import gc
from collections import defaultdict

from mfr_bench.config import load
from mfr_bench.config.model import Scene as SceneConfig
from mfr_bench.glsl.digest import code_of_programs
from mfr_bench.gpu.probes import COUNTED, ProbeBench
from mfr_bench.gpu.programs import MOST, Programs
from mfr_bench.methods import catalog
from mfr_bench.methods.spec import Fitted
from mfr_bench.plan import expand, expected_stats


class Object:
    """Stands for what moderngl holds of OpenGL's program."""

    def __init__(self, name: str, deleted: list[str]):
        self.release = lambda: deleted.append(name)


class Program:
    def __init__(self, name: str, deleted: list[str]):
        self.mglo = Object(name, deleted)


def get(programs: Programs, name: str, deleted: list[str]) -> Program:
    return programs.get((name,), lambda: Program(name, deleted))


def test_a_program_is_linked_once_while_it_is_kept():
    programs, deleted = Programs(most=2), []
    assert get(programs, "a", deleted) is get(programs, "a", deleted)


def test_what_was_used_longest_ago_is_deleted_when_another_is_linked():
    programs, deleted = Programs(most=2), []
    for name in ("a", "b", "a", "c"):
        get(programs, name, deleted)
    assert (set(programs), deleted) == ({("a",), ("c",)}, [])
    get(programs, "d", deleted)
    assert deleted == ["b"]


def test_a_program_in_use_stays_and_is_the_same():
    programs, deleted = Programs(most=1), []
    used = get(programs, "a", deleted)
    for name in ("b", "c", "d"):
        get(programs, name, deleted)
    assert get(programs, "a", deleted) is used
    assert deleted == ["b"]  # and c before the next is linked


def test_scenes_of_conformance_take_no_more_programs_than_are_kept():
    """The device draws all methods of a scene, then those of the next: with fewer, none would still be there."""
    found = defaultdict(set)
    for cell in expand(load("conformance", catalog(), "smoke")[0], catalog()):
        fitted = Fitted(catalog()[cell.method].variant(cell.params), expected_stats(cell.scene))
        found[cell.scene].update(*code_of_programs(fitted))
    assert 256 < max(map(len, found.values())) <= MOST


def test_frames_that_were_released_keep_no_program(device, monkeypatch):
    """Not even until Python looks for cycles, as a frame and its passes are one."""
    monkeypatch.setattr(device, "programs", Programs(most=0))
    gc.disable()
    try:
        with ProbeBench(device, SceneConfig(size=(8, 8), depth_complexity=2)) as bench:
            frame = bench.frame(COUNTED)
            frame.draw_fitting()
            drawn = len(device.programs)
            frame.release()
            assert (drawn >= 2, len(device.programs)) == (True, 0)
    finally:
        gc.enable()
