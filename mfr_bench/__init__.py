"""mfr-bench: the multi-fragment rendering benchmark."""

__version__ = "0.1.0"
