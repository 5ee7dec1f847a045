"""The next scene is made before its turn where another process can; whatever becomes of that, every scene is made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mfr_bench.run import answers
from mfr_bench.run.ahead import Ahead
from mfr_bench.run.answers import Answers
from mfr_bench.run.aside import AtOnce
from mfr_bench.scene import Scene

SCENE = Scene(size=(24, 20), depth_complexity=6)
OTHER = replace(SCENE, seed=9)


class Elsewhere(AtOnce):
    """Stands for another process: it knows scenes of its own."""

    another = True

    def __init__(self):
        super().__init__(Answers())


@pytest.fixture
def made(monkeypatch):
    """The configs whose scenes were generated, in order."""
    found, generate = [], answers.generate
    monkeypatch.setattr(answers, "generate", lambda config, *frame: found.append(config) or generate(config, *frame))
    return found


def test_a_scene_that_was_begun_is_not_made_again(made):
    ahead = Ahead(Answers(), lambda config: elsewhere)
    elsewhere = Elsewhere()
    ahead.begin(SCENE)
    assert made == [SCENE]
    (scene,), (stats,) = ahead.made(SCENE)
    assert made == [SCENE] and stats.F == 24 * 20 * 6
    assert np.array_equal(scene.rgba, answers.generate(SCENE).rgba)


def test_one_scene_at_most_is_begun_and_another_than_that_is_made_here(made):
    elsewhere = Elsewhere()
    ahead = Ahead(Answers(), lambda config: elsewhere)
    ahead.begin(SCENE)
    ahead.begin(OTHER)
    assert made == [SCENE]
    ahead.made(OTHER)
    ahead.made(SCENE)  # it was let go
    assert made == [SCENE, OTHER, SCENE]


def test_without_another_process_nothing_is_begun(made):
    ahead = Ahead(Answers(), lambda config: AtOnce(Answers()))
    ahead.begin(SCENE)
    assert made == []
    ahead.made(SCENE)
    assert made == [SCENE]
