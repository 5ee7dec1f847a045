"""Runs of cells: a process that owns the device measures; its parent plans, keeps, and outlives it.

    supervisor, hand                  the parent's loop over scenes, and what it knows of the cell in hand
    device_process, process           the worker that has the device, replaced where it dies; its link and its end
    trust                             has the device tested where a cell is wrong, and refuses one that fails
    ledger, settling, sheet           what is kept, shared, written: rows, and samples of unfinished cells
    jobs, events, memory              what both sides know, and what they say to each other
    parent, aside, shared             ties a process to its parent; work of the host in one more process; memory of both
    answers, ahead                    that work: right images, comparisons, compressed arrays; the next scene
    worker                            the process that measures: device, timer, its end of the link
    measuring, eliminating            on the device: the cells of a scene in turns, or in rounds that the slower leave
    cell, images, outcome             one cell sampled, its images checked, its status and values
    scene_work, bench                 the scene with its oracle images; the device and timer of all cells

Samples reach the parent batch by batch, and it has kept them before the worker goes on.
"""
