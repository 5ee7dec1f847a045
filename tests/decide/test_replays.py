"""The script that replays recorded races: it finds the fastest of planted frames, and counts the frames it drew."""

import importlib.util
import random
from pathlib import Path

import pytest

from mfr_bench.config import load
from mfr_bench.methods import catalog

RECORDED = Path(__file__).with_name("recorded")
SCRIPT = Path(__file__).parents[2] / "scripts" / "decide_replays.py"


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("decide_replays", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_fastest_wins_with_a_part_of_the_frames(script):
    rng = random.Random(1)  # noqa: S311 - planted noise
    cells = {str(i): [(1 + 0.3 * i) * (1 + rng.gauss(0, 0.05)) for _ in range(200)] for i in range(8)}
    ratio, drawn, full = script.replay(cells, rng)
    assert ratio == 1.0 and full == 1600 and drawn < full / 4


def test_99_of_100_replays_find_the_fastest_with_a_quarter_of_the_frames(script):
    """Recorded frames of 52 scenes, each raced twice with its rounds in another order; both halves of the scenes."""
    scenes = script.recorded(RECORDED)
    assert len(scenes) >= 50 and min(len(cells) for cells in scenes.values()) >= 2
    assert all(len(times) >= 200 for cells in scenes.values() for times in cells.values())
    rng = random.Random(0)  # noqa: S311 - as above
    outcomes = [script.replay(cells, rng) for _ in range(2) for cells in scenes.values()]
    for half in (outcomes, outcomes[::2], outcomes[1::2]):
        assert sum(ratio <= script.GOOD for ratio, *_ in half) >= 0.99 * len(half)
        assert sum(drawn for _, drawn, _ in half) <= 0.25 * sum(full for *_, full in half)


def test_every_scene_that_it_records_is_a_config(script, tmp_path):
    import yaml

    rng = random.Random(50)  # noqa: S311 - as above
    scenes = set()
    for number in range(50):
        made = script.config(number, rng, 4)
        path = tmp_path / f"{number}.yaml"
        path.write_text(yaml.safe_dump(made))
        experiment, = load(str(path), catalog())
        scenes.add(experiment.scene)
        assert len(experiment.methods) >= 4
    assert len(scenes) == 50
