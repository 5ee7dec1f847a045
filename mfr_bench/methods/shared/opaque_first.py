"""What opaque primitives hide is left out: they are drawn first, and all others are tested against their depth.

The geometry is drawn once, in two parts, and the test comes before the shader. Of the opaque primitives those are
stored as well that came before a nearer one: they show nothing of what is behind them, and are hidden like it.
"""

from __future__ import annotations

from dataclasses import replace

from ..spec import IMAGE, Known, Param, Params, Pass, Plan, State, Target, when
from .clearing import CLEARED

NEAREST = "nearest"  # the plan of frames whose primitives are all opaque
OPAQUE = Param("opaque", "tested", "opaque primitives: where enough lies behind them, a depth test leaves it out, and "
               "where all are opaque nothing is stored at all (tested); or they are stored like others (stored)",
               choices=("tested", "stored"))
IS_TESTED = when(OPAQUE.name, "tested")
NEAREST_DEPTH = Target("nearest_depth", "depth32f", when=IS_TESTED, on_demand=True,
                       doc="depth of the nearest opaque fragment so far")
FURTHEST = {NEAREST_DEPTH.name: (1.0,)}
DRAW_NEAREST = Pass("draw", "geometry", "methods/baseline/floor.frag", into=(IMAGE, NEAREST_DEPTH.name),
                    clears={IMAGE: CLEARED, **FURTHEST}, state=State(depth_test="lequal"),
                    runs_in=lambda plan: plan.path == NEAREST, when=IS_TESTED)
ENOUGH = 1 / 3  # of the fragments: to find fewer that are hidden takes about as long as it saves


def is_tested(known: Known, params: Params) -> bool:
    """Whether a depth test may find what opaque primitives hide; no budget has room for another depth."""
    return known.room is None and params.get(OPAQUE.name, OPAQUE.default) == "tested"


def hidden_share(known: Known) -> float:
    """The share of the fragments to expect behind opaque ones, as if each were opaque by chance, whatever its place.

    Of as many as a pixel of the rectangle has in the mean, those remain that come before the first opaque one, and it.
    """
    mean = known.expected / max(1, known.area)
    if mean * known.opaque == 0:
        return 0.0
    return 1.0 - (1.0 - (1.0 - known.opaque) ** mean) / (mean * known.opaque)


def is_in_front(known: Known, params: Params) -> bool:
    """Whether a frame that stores fragments leaves out what is hidden: by the geometry alone, alike in each frame."""
    return known.draws_in_parts and is_tested(known, params) and hidden_share(known) >= ENOUGH


def in_front(plan: Plan, params: Params) -> Plan:
    """The plan, of a frame that stores fragments, without those that are hidden where that pays."""
    return replace(plan, in_front=is_in_front(plan.known, params))


def whole_and_in_front(step: Pass) -> tuple[Pass, Pass]:
    """The geometry pass where all fragments are stored or counted, and where those that are hidden are left out."""
    def runs_in(plan: Plan, hidden_left_out: bool) -> bool:
        return plan.in_front == hidden_left_out and step.runs_in(plan)

    return (replace(step, runs_in=lambda plan: runs_in(plan, False)),
            replace(step, runs_in=lambda plan: runs_in(plan, True), into=(*step.into, NEAREST_DEPTH.name),
                    clears={**step.clears, **FURTHEST}, opaque_first=True,
                    state=replace(step.state, depth_test="lequal", early=True)).only(IS_TESTED))
