"""Runs when a process of the tests starts that has no fault planted."""

import calibrated  # noqa: F401  for its effect
