"""The script that replays recorded races: it finds the fastest of planted frames, and counts the frames it drew."""

import importlib.util
import random
from pathlib import Path

import pytest

from mfr_bench.config import load
from mfr_bench.methods import catalog

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


def test_every_scene_that_it_records_is_a_config(script, tmp_path):
    import yaml

    rng = random.Random(50)  # noqa: S311 - as above
    scenes = set()
    for number in range(50):
        made = script.config(number, rng, 4, 200)
        path = tmp_path / f"{number}.yaml"
        path.write_text(yaml.safe_dump(made))
        experiment, = load(str(path), catalog())
        scenes.add(experiment.scene)
        assert experiment.measure.max_samples == 200
    assert len(scenes) == 50
