"""One order for a frame: that of the fragments of one pixel, where every primitive has one depth in all of them."""

from __future__ import annotations

from ..spec import COMMAND_WORDS, IMAGE, OVER, Buffer, Known, Param, Params, Pass, Plan, State, when
from .clearing import CLEARED

ORDERED = "ordered"  # the plan of such frames
MOST_ORDERED = 2048  # primitives; to find their order takes a comparison of each with each
ORDERERS = 64  # invocations of a work group that finds the ranks of primitives

FLAT = Param("flat", "ordered", "primitives that all fill one rectangle, each at one depth: blended in the order of "
             "their depths, which is found once for all pixels (ordered), or stored like others (stored)",
             choices=("ordered", "stored"))
IS_ORDERED = when(FLAT.name, "ordered")
DRAWS_IN_ORDER = Buffer("order", f"{COMMAND_WORDS}*min(n, {MOST_ORDERED})", when=IS_ORDERED,
                        doc="indirect draw of each primitive, the furthest first")


def is_ordered(known: Known, params: Params) -> bool:
    """Whether the primitives of a frame are drawn in one order."""
    return known.filled and known.layers <= MOST_ORDERED and params.get(FLAT.name, FLAT.default) == "ordered"


def _orders(plan: Plan) -> bool:
    return plan.path == ORDERED


# The order of the primitives by the fragments of one pixel, and the primitives in that order.
IN_ORDER = (
    Pass("order", "geometry", "methods/adaptive/store_one.frag", corner=True, writes=("nodes",), runs_in=_orders,
         when=IS_ORDERED),
    Pass("order", "compute", "methods/adaptive/rank.comp", reads=("nodes",), writes=("order",), runs_in=_orders,
         when=IS_ORDERED,
         defines={"COMMAND_WORDS": COMMAND_WORDS, "ORDERERS": ORDERERS}, groups=f"ceil(n/{ORDERERS})"),
    Pass("blend", "geometry", "methods/baseline/floor.frag", into=(IMAGE,), clears={IMAGE: CLEARED}, command="order",
         state=State(blend=OVER), runs_in=_orders, when=IS_ORDERED, counts_for_plan=True),
)
