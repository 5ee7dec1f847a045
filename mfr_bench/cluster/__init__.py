"""Runs on many machines: shares of a run as tasks of an engine that is there (Slurm, or processes of one machine).

    settings     cluster.yaml
    task         one share on a node; ends its children, and may be requeued
    submission   the tasks of a store, and what submits them
    queue        the jobs of the engine
    state        the state of the tasks, by the cells that they wrote

A task is judged by its cells alone: engines report jobs as completed that never ran.
"""
