"""Plans the frames of a planned method: from the geometry of the scene, and from what the frame before has counted."""

from __future__ import annotations

from dataclasses import replace

from ..methods.spec import Fitted, Known, Plan
from ..scene.geometry import Geometry
from . import rawgl
from .rawgl import RawGL


class Schedule:
    """The plans of one frame after the other. `room`: most elements that the method's budget allows; None: any number.

    The fragments of a frame are counted by an occlusion query within it, which is read before the next frame, so that
    the host does not wait.
    """

    def __init__(self, gl: RawGL, fitted: Fitted):
        self._gl, self._fitted = gl, fitted
        self.room = fitted.room()
        self._fragments: int | None = None  # of the latest frame, once it is known
        self._counted_scene: Geometry | None = None  # the scene whose fragments are known, or are being counted
        self._pending = False  # the query has been made and not been read
        self._query = gl.generate("Queries")
        self._latest: tuple[Geometry, int | None, Plan] | None = None  # the newest plan, and what it was made from

    def next_plan(self, scene: Geometry) -> Plan:
        """The plan of the next frame, by what the host knows now."""
        if self._pending:
            self._fragments, self._pending = self._gl.query_result(self._query), False
        if not (self._latest and self._latest[0] is scene and self._latest[1] == self._fragments):
            *_, columns, rows = scene.bounds
            stats = replace(self._fitted.stats, primitives=len(scene), area=columns * rows, layers=scene.layers,
                            reach=scene.reach)
            known = Known.of(stats, self._fragments, self.room)
            plan = self._fitted.variant.method.capacity.rule(known, self._fitted.scope)
            self._latest = scene, self._fragments, plan
        return self._latest[2]

    def begin_count(self, scene: Geometry) -> bool:
        """Start to count what passes, where it is not known of this scene; whether it was started."""
        if self._counted_scene is scene:
            return False
        self._gl.glBeginQuery(rawgl.SAMPLES_PASSED, self._query)
        return True

    def end_count(self, scene: Geometry) -> None:
        """Stop counting what passes."""
        self._gl.glEndQuery(rawgl.SAMPLES_PASSED)
        self._pending, self._counted_scene = True, scene

    def learn(self, scene: Geometry, fragments: int) -> None:
        """Take the fragments of the frame that is drawn, as one of its passes has counted them."""
        self._fragments, self._counted_scene = fragments, scene

    def release(self) -> None:
        """Free the query."""
        self._gl.delete("Queries", self._query)
