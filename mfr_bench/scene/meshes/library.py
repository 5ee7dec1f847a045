"""Imports a mesh library when a file needs it, or says how to install it."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

from ...errors import UsageError


def library(name: str, path: Path):
    """The module of this name. Raises UsageError where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise UsageError(f"{path}: reading {path.suffix.upper().lstrip('.')} files needs the package {name}; "
                         "install it: make setup in the folder of mfr-bench, or "
                         f"{sys.executable} -m pip install 'mfr-bench[mesh]'") from None
