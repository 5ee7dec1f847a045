"""The vocabulary in which a method is declared. Declarations are data: they know no GL objects, YAML, files or plots.

    scene_stats  facts of a scene, over which formulas are written
    params       parameters with their choices, and conditions on them
    formulas     what a formula may say, and its value
    capacity     how a method gets to know for how many fragments it needs room
    resources    buffers and targets
    passes       passes with their state, and loops
    method       a method, and a variant: the method with every parameter chosen
    fitted       a variant bound to the statistics of its scene; memory
    maker        a scene from outside: what makes it, and its keys
    conditions   whether a frame runs a pass, and if not, for which reason

The catalog, the tables and the tests read declarations; `gpu.plan` makes plans of frames from them,
which `gpu.frame` executes.
"""

from .capacity import SPARE_CELLS, Choice, Counted, Decided, Grown, Known, Plan, Planned, Rule
from .conditions import REASONS, FrameState, left_out
from .fitted import ALPHA_STEPS, LEAF_ROUNDINGS, UNIT_ROUNDOFF, Fitted
from .formulas import doubled, evaluate
from .method import ONE, Guarantee, Method, Promise, Variant, Variants
from .params import ON_OFF, Above, Param, Params, Value, When, when
from .passes import (
    ADD,
    BEHIND,
    INVERTED_ALPHA,
    MAX,
    OVER,
    REVEAL,
    SEEN_THROUGH_BOTH,
    UNDER,
    Blend,
    Loop,
    Pass,
    State,
    Stencil,
)
from .resources import (
    COMMAND_WORDS,
    DISPATCH_OFFSET,
    ELEMENT_WORDS,
    EMPTY,
    FORMAT_WORDS,
    FRAMEBUFFER_FETCH,
    IMAGE,
    LISTED,
    MSAA_FEATURES,
    NEAREST_33,
    PAYLOAD_WORDS,
    SAMPLE_FEATURES,
    SAMPLE_STENCIL,
    TILE_COMMAND,
    TILE_LIST,
    TILE_POINTS,
    Buffer,
    Format,
    Target,
)
from .scene_stats import SCENE_FACTS, SceneStats

__all__ = [
    "ADD",
    "ALPHA_STEPS",
    "BEHIND",
    "COMMAND_WORDS",
    "DISPATCH_OFFSET",
    "ELEMENT_WORDS",
    "EMPTY",
    "FORMAT_WORDS",
    "FRAMEBUFFER_FETCH",
    "IMAGE",
    "INVERTED_ALPHA",
    "LEAF_ROUNDINGS",
    "LISTED",
    "MAX",
    "MSAA_FEATURES",
    "NEAREST_33",
    "ONE",
    "ON_OFF",
    "OVER",
    "PAYLOAD_WORDS",
    "REASONS",
    "REVEAL",
    "SAMPLE_FEATURES",
    "SAMPLE_STENCIL",
    "SCENE_FACTS",
    "SEEN_THROUGH_BOTH",
    "SPARE_CELLS",
    "TILE_COMMAND",
    "TILE_LIST",
    "TILE_POINTS",
    "UNDER",
    "UNIT_ROUNDOFF",
    "Above",
    "Blend",
    "Buffer",
    "Choice",
    "Counted",
    "Decided",
    "Fitted",
    "Format",
    "FrameState",
    "Grown",
    "Guarantee",
    "Known",
    "Loop",
    "Method",
    "Param",
    "Params",
    "Pass",
    "Plan",
    "Planned",
    "Promise",
    "Rule",
    "SceneStats",
    "State",
    "Stencil",
    "Target",
    "Value",
    "Variant",
    "Variants",
    "When",
    "doubled",
    "evaluate",
    "left_out",
    "when",
]
