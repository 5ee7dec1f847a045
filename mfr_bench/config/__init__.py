"""YAML -> frozen dataclasses, with every mistake found before anything runs.

A name is loaded when it is first used: what measures takes configs that are read.
"""

from typing import TYPE_CHECKING

from ..lazy import from_modules

if TYPE_CHECKING:
    from .json_schema import schema
    from .loading import find, load, shipped, stress_configs
    from .model import Experiment, Figure, Scene
    from .settings import Measure, MethodEntry

__getattr__ = from_modules(__name__, {
    **dict.fromkeys(("find", "load", "shipped", "stress_configs"), "loading"),
    **dict.fromkeys(("Experiment", "Figure", "Scene"), "model"),
    **dict.fromkeys(("Measure", "MethodEntry"), "settings"), "schema": "json_schema"})
__all__ = ["Experiment", "Figure", "Measure", "MethodEntry", "Scene", "find", "load", "schema", "shipped",
           "stress_configs"]
