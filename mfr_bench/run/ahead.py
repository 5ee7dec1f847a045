"""The next scene, made in the process beside the device while this one is measured."""

from __future__ import annotations

import pickle
from collections.abc import Callable

from ..methods.spec import SceneStats
from ..scene import Scene
from ..scene.geometry import Geometry
from .answers import Answers, Make
from .aside import Aside, Pending

Frames = tuple[list[Geometry], list[SceneStats | None]]


class Ahead:
    """Makes at most one scene before its turn. answers: of this process, which makes every other scene."""

    def __init__(self, answers: Answers, aside_for: Callable[[Scene], Aside]):
        self._answers, self._aside_for = answers, aside_for
        self._next: tuple[Scene, Pending[bytes]] | None = None

    def begin(self, config: Scene) -> None:
        """Begin to make a scene, if another process can."""
        aside = self._aside_for(config)
        if aside.another and self._next is None:
            self._next = config, aside.begin(Make(config))

    def made(self, config: Scene) -> Frames:
        """The frames of a scene with their statistics, None where the device has to count.

        Raises what its generator raises, whichever process it ran in.
        """
        begun, self._next = self._next, None
        if begun and begun[0] == config:
            return pickle.loads(begun[1]())  # noqa: S301 - from a process of this run
        return self._answers.made(config)
