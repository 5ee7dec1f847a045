"""The contract that every method has to keep: what its declaration says, and what its shaders draw; and those of scenes
and effects from outside.

    variants     the variants of a method that are checked; no GL
    preprocess   the lines of a shader that its compiler sees
    declaration  what a declaration says, and what its shaders look like; no GL
    cases        small scenes that differ in what can go wrong, and frames drawn of them
    images       every image against the oracle
    guards       no write outside a buffer
    suite        all of it for one method, as `mfr-bench check` runs it
    of_scene     the contract of scenes from outside
    of_effect    the contract of effects

A check gives a line for each thing that is not as it should be. The tests of this project call the same checks.
"""
