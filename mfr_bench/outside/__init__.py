"""Packages and folders that bring methods, effects and scenes, seen from their own side.

    loader     the process that imports one of them, and tells what it declares
    entries    what a module declares under one name, and the mistakes of it
    effects    the effects among that, and whether each is whole
    scenes     the scenes among that
    making     the process that makes the fragments of one of them
    template   the packages that `mfr-bench new-method` and its siblings write
"""
