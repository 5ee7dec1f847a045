"""Shader text. Python owns the numbers that both sides need; the prelude carries them into GLSL.

    includes  files with every include in place, errors mapped back to file and line
    bindings  where shaders find buffers, textures and the counters of diagnostics
    prelude   all that stands before a shader's own text, and the stages of a pass
    code      the text without comments, which the key of a measured cell covers
    digest    the hash by which a cell knows its shaders
    counters  text that counts its work, for frames that are not timed
"""

from .bindings import split_ref
from .includes import StageSource, expand, read
from .prelude import FEATURE_EXTENSIONS, define_values, source, stages

__all__ = ["FEATURE_EXTENSIONS", "StageSource", "define_values", "expand", "read", "source", "split_ref", "stages"]
