"""Tables and figures of result folders. This package reads the store and nothing else."""

from .conformance import conformance_page
from .figures import write_all, write_figures, write_together
from .tables import breaking_text, markdown, terminal_table, write_tables

__all__ = ["breaking_text", "conformance_page", "markdown", "terminal_table", "write_all", "write_figures",
           "write_tables", "write_together"]
