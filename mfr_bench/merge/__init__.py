"""Results of several machines and runs as one set: every cell checked, none contradicted, and who measured it kept."""

from .plan import Merged, merged_sets
from .write import Written, write_set

__all__ = ["Merged", "Written", "merged_sets", "write_set"]
