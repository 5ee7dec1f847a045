"""Runs of cells: a process that owns the device measures; its parent plans, keeps, and outlives it.

    supervisor, process               the parent's loop over scenes, and its hold on the worker
    ledger                            what is kept, shared, written: rows, and samples of unfinished cells
    jobs, events, memory              what both sides know, and what they say to each other
    worker                            the process that measures: device, timer, its end of the link
    measuring, cell, scene_work       on the device: the cells of a scene in turns, one of them, the scene itself

Samples reach the parent batch by batch, and it has kept them before the worker goes on.
"""
