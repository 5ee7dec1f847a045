"""Tables and figures of result folders. This package reads the store and nothing else."""

from .conformance import conformance_page
from .devices import write_together
from .figures import write_all, write_figures
from .figures.scaled import write_scaled
from .tables import breaking_text, markdown, terminal_table, write_for_paper, write_tables

__all__ = ["breaking_text", "conformance_page", "markdown", "terminal_table", "write_all",
           "write_figures", "write_for_paper", "write_scaled", "write_tables", "write_together"]
