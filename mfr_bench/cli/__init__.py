"""The command line: parses, calls, prints. Modules that cost time to import are imported where they are used."""

from .main import main

__all__ = ["main"]
