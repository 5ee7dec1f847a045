"""Answers computed without the GPU in float64: composites, error measures, rounding, two-channel colour."""
