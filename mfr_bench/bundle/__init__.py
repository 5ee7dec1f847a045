"""Bundles: results to send to a public collection. Data, never code; read with limits, checked before they are used."""

from .archive import read_bundle
from .make import make_bundle
from .verify import Finding, verified

__all__ = ["Finding", "make_bundle", "read_bundle", "verified"]
