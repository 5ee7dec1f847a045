"""Runs on many machines: shares of a run as tasks of an engine that is there (Slurm, or processes of one machine).

    settings     cluster.yaml
    task         what a node runs; ends its children, and may be requeued
    submission   the tasks of a store, and what submits them
    queue        what the engine says of its jobs
    state        what the tasks have done, by the cells that they wrote

A task is judged by its cells alone: engines report jobs as completed that never ran.
"""
