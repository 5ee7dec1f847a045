"""One HTML page from result folders: opens from disk, asks nothing of a network, and names no host, user or path."""

from .trend import write_trend
from .write import page_text, write_page

__all__ = ["page_text", "write_page", "write_trend"]
