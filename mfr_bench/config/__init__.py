"""YAML -> frozen dataclasses, with every mistake found before anything runs."""

from .layout import block, covered_pixels, quad_count
from .load import find, load, shipped, stress_configs
from .model import Experiment, Figure, Measure, MethodEntry, Scene
from .schema import schema

__all__ = ["Experiment", "Figure", "Measure", "MethodEntry", "Scene", "block", "covered_pixels", "find", "load",
           "quad_count", "schema", "shipped", "stress_configs"]
