"""mfr-bench: the multi-fragment rendering benchmark. `load` and `plot` are its API: docs/api.md."""

from __future__ import annotations

TYPE_CHECKING = False  # type checkers take it for true; without typing, Ctrl-C is answered sooner
if TYPE_CHECKING:
    from typing import Any

    from .api import load, plot

__version__ = "0.1.0"
__all__ = ["__version__", "load", "plot"]


def __getattr__(name: str) -> Any:
    """Load the API where it is first used, so that the commands start at once."""
    if name in ("load", "plot"):
        from . import api

        return getattr(api, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
