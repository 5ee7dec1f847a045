"""Small methods with known results, and a scene to run them on; declared and run like the methods under test."""

from __future__ import annotations

from ..methods.shared import MULTISAMPLING, SYNC, K, clear, resolve, route, routed_targets
from ..methods.spec import IMAGE, Buffer, Fitted, Method, Pass, when
from ..oracle.composite import stats_of
from ..scene import Scene as SceneConfig
from ..scene import generate
from .context import Device
from .frame import Frame
from .scene_buffer import SceneBuffer
from .targets import Canvas

ROUTED_SCENE = SceneConfig(size=(16, 16), depth_complexity=4)


def probe_method(name: str, *steps: Pass, buffers: tuple[Buffer, ...] = (), **more) -> Method:
    """A method that promises no image, for one of the tests here."""
    return Method(id=f"probe-{name}", name=name, family="probe", source="self-test", summary="", guarantee="none",
                  words="0", ties="", steps=steps, buffers=buffers, **more)


COUNTER = Buffer("counter", "P", clear="0u", coherent=True)
SHOW = Pass("show", "fullscreen", "probe/show_count.frag", reads=("counter",), into=(IMAGE,))
COUNT = Pass("count", "geometry", "common/count.frag", writes=("counter",))

ATOMICS = probe_method("atomics", clear("total"), Pass("count", "geometry", "probe/total.frag", writes=("total",)),
                       buffers=(Buffer("total", "1", clear="0u"),))
COUNTED = probe_method("side effects", clear("counter"), COUNT, SHOW, buffers=(COUNTER,))
SEMAPHORE = Buffer("semaphore", "P", clear="0u", coherent=True, when=when("sync", "spin"))
LOCKED = probe_method(
    "lock", clear("counter", "semaphore"),
    Pass("count", "geometry", "probe/locked_count.frag", writes=("counter", "semaphore")), SHOW,
    buffers=(COUNTER, SEMAPHORE), params=(SYNC,))
ROUTED = probe_method(
    "stencil routing", *route("k"), resolve("depths", "colours", fetch="methods/routing/fetch.glsl"),
    targets=routed_targets("k"), params=(MULTISAMPLING,), fixed=(K.at(4),), local="k")


class ProbeBench:
    """One scene on the device, on which probes run. A context: leaving it releases the scene."""

    def __init__(self, device: Device, config: SceneConfig):
        self.device = device
        self.scene = generate(config)
        self.stats = stats_of(self.scene)
        self.scene_buffer = SceneBuffer(device, self.scene)
        self.canvas = Canvas(device, (self.stats.W, self.stats.H))

    def __enter__(self):
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def frame(self, method: Method, **params) -> Frame:
        return Frame(self.device, Fitted(method.variant(params), self.stats), self.scene_buffer, self.canvas)

    def release(self) -> None:
        self.scene_buffer.release()
        self.canvas.release()
