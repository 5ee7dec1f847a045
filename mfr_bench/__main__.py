"""`python -m mfr_bench`."""

from .cli import main

main()
