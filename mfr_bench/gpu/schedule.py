"""Plans the frames of a planned method: from the geometry of the scene, and from what the frame before has counted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ..methods.spec import Fitted, Known, Plan
from ..scene.geometry import Geometry
from . import rawgl
from .rawgl import RawGL

SPARE_LAYERS = 8  # of as many that a frame was found to need, one more is held ready for the frames that follow


class Schedule:
    """The plans of one frame after the other. `room`: most elements that the method's budget allows; None: any number.

    The fragments of a frame are counted by an occlusion query within it, which is read before the next frame, so that
    the host does not wait. `deepest` reads the word in which a frame leaves the fragments of its deepest pixel: before
    the next frame, or, where the room of a pixel was a guess, after the first frame of each scene.
    """

    def __init__(self, gl: RawGL, fitted: Fitted, deepest: Callable[[], int]):
        self._gl, self._fitted, self._read_deepest = gl, fitted, deepest
        self.room = fitted.room()
        self._fragments: int | None = None  # of the latest frame, once it is known
        self._counted_scene: Geometry | None = None  # the scene whose fragments are known, or are being counted
        self._pending = False  # the query has been made and not been read
        self._query = gl.generate("Queries")
        self._deepest: int | None = None  # layers that the frames before were found to need
        self._deepest_pending = False  # a frame has left them, and they have not been read
        self._deepest_scene: Geometry | None = None  # the scene whose deepest pixel is known to have room
        self._latest: tuple[Geometry, int | None, int | None, Plan] | None = None  # newest, and what it was made from

    def next_plan(self, scene: Geometry) -> Plan:
        """The plan of the next frame, by what the host knows now."""
        if self._pending:
            self._fragments, self._pending = self._gl.query_result(self._query), False
        if self._deepest_pending:
            self._deepest, self._deepest_pending = max(1, self._read_deepest()), False
        if not (self._latest and self._latest[0] is scene and self._latest[1:3] == (self._fragments, self._deepest)):
            self._latest = scene, self._fragments, self._deepest, self._made(scene)
        return self._latest[3]

    def _made(self, scene: Geometry) -> Plan:
        """The plan that the method makes from what is known now."""
        *_, columns, rows = scene.bounds
        stats = replace(self._fitted.stats, primitives=len(scene), area=columns * rows, layers=scene.layers,
                        reach=scene.reach, opaque_primitives=scene.opaque_primitives, expected=scene.expected)
        known = Known.of(stats, self._fragments, self.room, self._deepest, self._fitted.fetches)
        return self._fitted.variant.method.capacity.rule(known, self._fitted.scope)

    def had_room(self, scene: Geometry, plan: Plan) -> bool:
        """Whether every pixel of the frame that was drawn by this plan had room; takes what it tells of the deepest."""
        if self._deepest_scene is scene:
            return True
        if plan.guessed and (needed := self._read_deepest()):
            self._deepest = needed + -(-needed // SPARE_LAYERS)
            return False
        if plan.guessed or plan.finds_deepest:
            self._deepest_scene, self._deepest_pending = scene, plan.finds_deepest
        return True

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
