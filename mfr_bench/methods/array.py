"""A-buffers with an array of fixed length per pixel."""

from __future__ import annotations

from .shared import OCCUPANCY, PAYLOAD, RESOLVE_OPTIONS, K, clear, occupied, resolve
from .shared.screen_region import TOUCHED, in_screen_region
from .spec import Buffer, Method, Param, Pass

ORDER = 2


ROOM = Param("room", 0, "slots of a pixel; 0: as many as the deepest has fragments (kplus_2015 §5.3 has too few)",
             low=0, high=65536, counts_losses=True,
             weakens={"1-65536": "of more fragments of a pixel than `room`, those that come later are lost"})
SLOTS = {"SLOTS": "min(room or n, n)"}


def array(method_id: str, name: str, source: str, summary: str, *params: Param, select: bool = False,
          **more) -> Method:
    """Slots for as many fragments as the deepest pixel has; with `select` the resolve picks the k nearest."""
    store = Pass("store", "geometry", "methods/array/store.frag", writes=("counter", "nodes"), defines=SLOTS)
    return Method(
        id=method_id, name=name, family="array", source=source, summary=summary, words="2*n + 1",
        beside="with `room` below n, as many words fewer",
        params=(*params, ROOM, *RESOLVE_OPTIONS, TOUCHED, PAYLOAD),
        buffers=(Buffer("counter", "P", clear="0u", doc="fragments of each pixel"),
                 Buffer("nodes", "2*min(room or n, n)*P", type="FRAGMENT",
                        doc="fragments of each pixel, in order of arrival")),
        steps=in_screen_region(
            clear("counter"),
            *(occupied(store) if select else (store,)),
            resolve("counter", "nodes", fetch="methods/array/fetch.glsl", texels=("nodes",), select=select,
                    defines=SLOTS),
        ),
        **more,
    )


METHODS = [
    array("ab-array", "AB_Array", "Crassin 2010; Liu et al. 2010 (FreePipe); kplus_2015 §2",
          "n slots per pixel, given out by an atomic counter; needs n beforehand",
          guarantee="exact all", ties="kept, in no fixed order"),
    array("kb-ab-array", "KB-AB_Array", "kplus_2015 §2, §5",
          "n slots per pixel for all fragments; the resolve picks the k nearest", K, OCCUPANCY, select=True,
          guarantee="exact k nearest", ties="kept, in no fixed order; any of them may win the last place", local="k"),
]
