"""Packages and folders that bring methods, seen from their own side.

    loader     the process that imports one of them, and tells what it declares
    template   the package that `mfr-bench new-method` writes
"""
