"""A scene for mfr-bench, declared in spiral.py."""
