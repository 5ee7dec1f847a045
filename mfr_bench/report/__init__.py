"""Tables and figures of result folders. This package reads the store and nothing else.

A name is loaded when it is first used: most users need one of them.
"""

from typing import TYPE_CHECKING

from ..lazy import from_modules

if TYPE_CHECKING:
    from .conformance import conformance_page
    from .devices import write_together
    from .figures import write_all, write_figures
    from .figures.scaled import write_scaled
    from .tables import breaking_text, markdown, terminal_table, write_for_paper, write_tables

__getattr__ = from_modules(__name__, {
    "breaking_text": "tables", "conformance_page": "conformance", "markdown": "tables", "terminal_table": "tables",
    "write_all": "figures", "write_figures": "figures", "write_for_paper": "tables", "write_scaled": "figures.scaled",
    "write_tables": "tables", "write_together": "devices"})
__all__ = ["breaking_text", "conformance_page", "markdown", "terminal_table", "write_all",
           "write_figures", "write_for_paper", "write_scaled", "write_tables", "write_together"]
