"""Runs of cells: a process that owns the device measures; its parent plans, keeps, and outlives it."""
