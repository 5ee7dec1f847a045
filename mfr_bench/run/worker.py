"""The process that measures: owns the OpenGL context, takes groups of cells, emits what becomes of them."""

from __future__ import annotations

import os
import sys
import time
from contextlib import suppress
from dataclasses import asdict
from multiprocessing.connection import Connection
from typing import NoReturn

from ..errors import DeviceError, UnknownDeviceError
from ..gpu.context import Device
from ..gpu.device import open_device
from ..gpu.reference import ReferenceFrame
from ..gpu.selftest import calibrate, self_tests
from ..gpu.timers import GpuTimer, WallTimer
from ..measure.watch import Watch
from ..methods import catalog
from ..methods.spec import TILE_POINTS
from .answers import Answers
from .aside import OtherProcess
from .bench import Bench
from .events import Calibrate, Calibrated, Ended, Failed, Go, Needs, Ready, SelfTest, SelfTested, Synced
from .first_frames import serve as draw_ahead
from .measuring import DeviceLost, Measuring
from .parent import live_for
from .precompile import AT_ONCE, COLD_S, Precompiler, helps
from .standby import Standby

TIMERS = {timer.name: timer for timer in (GpuTimer, WallTimer)}
LOST = 3  # exit status


def main() -> None:
    """Arguments: the parent's end of the link, its process id, the kind of device, the timer or nothing."""
    descriptor, parent, want, timer = sys.argv[1:]
    live_for(int(parent))
    status = LOST
    # The last two errors: the parent needs no more.
    with suppress(DeviceLost, EOFError, ConnectionError), Standby() as standby:
        status = serve(Connection(int(descriptor)), want, timer, standby)
    os._exit(status)  # without the exit handlers of a driver, which may hang


def serve(link: Connection, want: str, timer: str, standby: Standby) -> int:
    """Open the device and measure what is asked for. Ends by DeviceLost, by EOFError and ConnectionError where the
    parent has closed the link, or with an exit status where there is no device."""
    try:
        device = open_device(want)
    except DeviceError as error:
        link.send(Failed(str(error), isinstance(error, UnknownDeviceError)))
        return LOST
    begun = time.monotonic()
    calibration = {} if timer else asdict(calibrate(device))
    calibrated_s = time.monotonic() - begun
    timer = timer or calibration["timer"]
    needs: Needs = link.recv()
    tried_s = try_out(device, needs)
    channel = Channel(link)
    answers = Answers()
    beside = OtherProcess(device.kind == "cpu", answers)
    watch = Watch(ReferenceFrame(device))
    bench = Bench(device, TIMERS[timer](device), channel.emit, channel.interrupted, answers, beside, watch,
                  precompiler_for(device, standby))
    link.send(Ready(device.info, device.limits, timer, calibration, device.bound_threads, calibrated_s,
                    device.instructions))
    try:
        if tried_s > COLD_S * (1 + device.wants(TILE_POINTS)) and needs.cells >= AT_ONCE:  # whose trial is the longest
            bench.precompiler.start()
        watch.look()  # compiles the reference frame while the run is still being planned
        answer(link, bench)
    finally:
        bench.precompiler.close()


def try_out(device: Device, needs: Needs) -> float:
    """Run the trials of what is needed. Returns this thread's processor time for it: most compile the programs."""
    device.wanted = needs.features
    begun_s = time.thread_time()
    for found in ("limits", "flushes_dispatches"):
        getattr(device, found)
    return time.thread_time() - begun_s


def precompiler_for(device: Device, standby: Standby) -> Precompiler:
    """The process that compiles ahead on the same device; one that is never started where it would not help."""
    if not helps(device.info["slug"]):
        standby.end()
        return Precompiler(None)
    return Precompiler(draw_ahead, device.egl.index, device.wanted, device.failed_trials, device.flushes_dispatches,
                       begin=standby.begin)


def answer(link: Connection, bench: Bench) -> NoReturn:
    """Measure the groups that come, calibrate or run self-tests where asked to, until the parent closes the link."""
    measuring = Measuring(bench, catalog())
    while True:
        group = link.recv()
        if isinstance(group, Calibrate):
            with bench.paused():
                link.send(Calibrated(asdict(calibrate(bench.device, again=True))))
            continue
        if isinstance(group, SelfTest):
            link.send(SelfTested({found.name: found.detail for found in self_tests(bench.device) if found.harmful}))
            continue
        interrupted = False
        try:
            measuring.group(group)
        except KeyboardInterrupt:
            interrupted = True
        link.send(Ended(bench.split.taken(), interrupted, bench.beside.taken_s() | bench.precompiler.taken_s()))


class Channel:
    """The worker's end of the link while it measures. All that the parent sends then is `Go` and `Stop`."""

    def __init__(self, link: Connection):
        self._link, self._stopping = link, False

    def emit(self, event: object) -> None:
        self._link.send(event)
        if isinstance(event, Synced):
            while not isinstance(self._link.recv(), Go):
                self._stopping = True

    def interrupted(self) -> bool:
        while self._link.poll(0):
            self._link.recv()
            self._stopping = True
        return self._stopping
