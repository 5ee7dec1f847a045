"""The claims, found by scanning this package: a file for each line of papers lists its own in `CLAIMS`.

They are listed in the order of the files' `ORDER`; a file without it comes last.
"""

from __future__ import annotations

import importlib
import math
import pkgutil

from ..verdict import Claim


def _found() -> tuple[Claim, ...]:
    files = [importlib.import_module(f"{__name__}.{module.name}") for module in pkgutil.iter_modules(__path__)]
    return tuple(claim for file in sorted(files, key=lambda f: getattr(f, "ORDER", math.inf)) for claim in file.CLAIMS)


CLAIMS = _found()
