"""The script that measures `adaptive` beside others: its arithmetic, its turns, and that it goes on where it was."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from mfr_bench.config.model import Scene
from mfr_bench.gpu.single import shown
from mfr_bench.oracle.composite import composite
from mfr_bench.scene import generate
from mfr_bench.store.status import EXACT_ERROR

SCRIPTS = Path(__file__).resolve().parent.parent / "scripts"


def loaded(monkeypatch, name: str):
    spec = importlib.util.spec_from_file_location(name, SCRIPTS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, name, module)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def turns(monkeypatch):
    return loaded(monkeypatch, "in_turns")


@pytest.fixture
def script(monkeypatch, turns):
    return loaded(monkeypatch, "adaptive_scenes")


class Clocked:
    """A frame that takes processor time, and a device that has always finished."""

    def __init__(self, ms: float, log: list):
        self.ms, self.log = ms, log

    def draw(self) -> None:
        self.log.append(self)

    def finish(self) -> None:
        pass


def test_frames_are_drawn_in_turns_there_and_back_with_as_many_in_each(turns, monkeypatch):
    log: list[Clocked] = []
    frames = {"slow": Clocked(8.0, log), "fast": Clocked(4.0, log)}
    monkeypatch.setattr(turns.time, "process_time", lambda: sum(frame.ms for frame in log) / 1e3)
    assert turns.in_turns(Clocked(0, log), frames, 3) == {
        "slow": pytest.approx([8.0] * 3), "fast": pytest.approx([4.0] * 3)}
    slow, fast = [frames["slow"]] * 3, [frames["fast"]] * 3
    assert log[2:] == [*fast, *slow, *slow, *fast, *fast, *slow]


@pytest.mark.parametrize(("frame_ms", "frames"), [(0.0, 20), (0.1, 20), (3.0, 4), (10.0, 1), (500.0, 1)])
def test_a_turn_takes_ten_milliseconds(turns, frame_ms, frames):
    assert turns.frames_of_a_turn(frame_ms) == frames


def test_a_ratio_is_the_median_of_those_of_the_rounds(turns):
    low, middle, high = turns.ratio([2, 4, 6, 8, 10, 12, 28], [2, 2, 2, 2, 2, 2, 2])
    assert middle == 4 and 1 <= low < 4 < high <= 14
    assert turns.ratio([1, 3], [2, 2]) == (None, 1, None)
    with pytest.raises(ValueError, match="argument 2"):
        turns.ratio([1, 2], [1])


def test_a_geometric_mean(turns):
    assert turns.geometric_mean([0.5, 2, 8]) == pytest.approx(2)


def test_rows_are_appended_and_read_back(turns, tmp_path):
    path = tmp_path / "rows.csv"
    assert turns.rows_of(path) == []
    for scene in ("a, b", "c"):
        turns.add_row(path, {"scene": scene, "ms": 1.5})
    assert turns.rows_of(path) == [{"scene": "a, b", "ms": "1.5"}, {"scene": "c", "ms": "1.5"}]


TIMES = {"adaptive": [6.0] * 7, "floor": [3.0] * 7, "ab-ll": [9.0] * 7, "ab-array": [8.0] * 7}


def test_the_fastest_other_is_compared_with(script):
    assert script.compared(TIMES) == {"ms": 6.0, "fastest": "ab-array", "fastest_ms": 8.0, "ratio": 0.75, "low": 0.75,
                                      "high": 0.75, "floor": 2.0, "reuse": ""}


def test_the_table_has_a_line_for_each_scene_and_sums_them_up(script, turns, tmp_path):
    path = tmp_path / "rows.csv"
    for scene, most, times in (("temple, 60 layers", 60, TIMES), ("slanted", 8, TIMES | {"ab-ll": [1.5] * 7})):
        turns.add_row(path, {"scene": scene, "mean": 2.0, "most": most, "covered": 0.28, "plan": "guessed",
                             **script.compared(times)})
    lines = script.as_table(turns.rows_of(path)).splitlines()
    assert lines[2] == ("| temple, 60 layers | 2, 60 | 28 % | guessed | 6.0 | AB_Array 8.0 | 0.75 [0.75, 0.75] | 2.00 "
                        "|  |")
    assert lines[5:] == ["all scenes: fastest in 1 of 2, at most 4.00, geometric mean 1.732",
                         "meshes and their stand-ins: fastest in 1 of 1, at most 0.75, geometric mean 0.750",
                         "of these, without opaque ones: fastest in 1 of 1, at most 0.75, geometric mean 0.750",
                         "of these, more than 16 layers: fastest in 1 of 1, at most 0.75, geometric mean 0.750"]


def test_a_scene_that_has_a_row_is_not_measured_again(script, tmp_path, monkeypatch, capsys):
    asked = []

    def measured(_, name, *__):
        asked.append(name)
        return {"scene": name, "mean": 2.0, "most": 8, "covered": 0.5, "plan": "guessed", **script.compared(TIMES)}

    monkeypatch.setattr(script, "measured", measured)
    monkeypatch.setattr(script, "open_device", lambda _: None)
    for only in ("knot", "mesh", "mesh"):
        monkeypatch.setattr(sys, "argv", ["adaptive_scenes.py", str(tmp_path / "rows.csv"), "--only", only])
        script.main()
    assert asked == ["mesh knot.obj", "mesh solids.obj"]
    assert "| mesh solids.obj | 2, 8 |" in capsys.readouterr().out


@pytest.mark.parametrize(("name", "share"), [("a", 0.0), ("a, a third opaque", 1 / 3), ("a, half opaque", 1 / 2),
                                            ("a, 10 % opaque", 0.1)])
def test_a_share_of_the_primitives_is_opaque_where_the_name_says_so(script, name, share):
    made = script.made(name, script.stand_in("hairball", 16, 8))
    assert made.opaque_primitives / len(made) == pytest.approx(share, abs=0.05)


def test_scenes_in_part_opaque_say_how_much_in_their_names(script):
    assert not script.PARTLY_OPAQUE.keys() & {*script.SCENES, *script.DEEP, *script.SMALL}
    assert {name.rpartition(", ")[2] for name in script.PARTLY_OPAQUE} <= script.PARTS.keys()


def test_small_scenes_have_as_many_layers_as_their_names_say(script):
    assert not script.SMALL.keys() & {*script.SCENES, *script.DEEP}
    for name, scene in script.SMALL.items():
        assert f", {scene.depth_complexity} layers at 96 × 96" in name and scene.size == (96, 96)


@pytest.mark.parametrize(("order", "right"), [("front_to_back", True), ("back_to_front", False)])
def test_the_bound_blends_fragments_as_they_come(script, device, order, right):
    config = Scene(size=(24, 20), depth_complexity=5, order=order)
    with shown(device, generate(config)) as on:
        image = on.render(script.variant_of(script.BOUND))
        assert (np.abs(image - composite(on.scene_buffer.scene)).max() <= EXACT_ERROR) == right


def test_the_bound_is_compared_as_the_method_is(script):
    times = {**TIMES, script.BOUND: [4.0] * 7}
    assert script.compared(times, script.BOUND)["ratio"] == 0.5
