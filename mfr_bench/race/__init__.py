"""Races seen without a GPU: a method's own GLSL, translated to C++ and run under an adversarial scheduler.

`adapter` makes the frame of a variant: its passes with their GLSL, and its buffers. `syntax`, `parser` and `cpp` turn
that GLSL into C++, `build` compiles it with the runtime in `machine/`, and `check` runs it and judges what it reports.
`report` prints the shortest interleaving found. What the machine does and leaves out: docs/races.md.
"""
