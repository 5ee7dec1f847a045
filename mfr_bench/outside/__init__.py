"""Packages and folders that bring methods and effects, seen from their own side.

    loader     the process that imports one of them, and tells what it declares
    effects    the effects among that, and whether each is whole
    template   the package that `mfr-bench new-method` writes
"""
