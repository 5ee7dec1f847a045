"""Finds the files that come with the package: inside it when installed, next to it in the repository."""

from __future__ import annotations

from pathlib import Path

from .errors import MfrError

PACKAGE = Path(__file__).resolve().parent


def configs_dir() -> Path:
    """The folder of the shipped configs. Raises MfrError where the installation lacks it."""
    return _folder("configs")


def shaders_dir() -> Path:
    """The folder of the GLSL. Raises MfrError where the installation lacks it."""
    return _folder("shaders")


def reference_dir() -> Path:
    """The folder of the numbers that the papers print. Raises MfrError where the installation lacks it."""
    return _folder("reference", "results/reference")


def peers_dir() -> Path:
    """The folder of comparisons with independent implementations. Raises MfrError where the installation lacks it."""
    return _folder("peers", "results/peers")


def template_dir(name: str) -> Path:
    """The folder of an example that `new-method` and its siblings copy. Raises MfrError where it is missing."""
    return _folder(f"templates/{name}", f"examples/{name}")


def _folder(name: str, beside: str | None = None) -> Path:
    """The folder `name` of an installed package, `beside` (by default the same name) in the repository."""
    places = (PACKAGE / "_data" / name, PACKAGE.parent / (beside or name))
    for place in places:
        if place.is_dir():
            return place
    raise MfrError(f"the {name} of mfr-bench are missing: neither {places[0]} nor {places[1]} is a folder; "
                   "reinstall mfr-bench")
