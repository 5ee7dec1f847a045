"""YAML -> frozen dataclasses, with every mistake found before anything runs."""

from .load import find, load, shipped, stress_configs
from .model import Experiment, Figure, Measure, MethodEntry, Scene
from .schema import schema

__all__ = ["Experiment", "Figure", "Measure", "MethodEntry", "Scene", "find", "load", "schema", "shipped",
           "stress_configs"]
