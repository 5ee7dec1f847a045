"""A worker without a process of its own: the tests' device can be used by their own process alone."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import asdict
from types import MappingProxyType

from mfr_bench.gpu import device as devices
from mfr_bench.gpu.selftest import calibrate
from mfr_bench.methods import catalog
from mfr_bench.run.bench import Bench
from mfr_bench.run.events import Calibrate, Calibrated, Ended, Group, Ready, SelfTest, SelfTested
from mfr_bench.run.measuring import Measuring
from mfr_bench.run.process import Died
from mfr_bench.run.worker import TIMERS

CALIBRATIONS: dict[int, dict] = {}  # by the identity of the device, which lives as long as the tests do


def calibration_of(device) -> dict:
    """What the device's calibration finds, once for all commands of the tests: it takes longer than most of them."""
    if id(device) not in CALIBRATIONS:
        CALIBRATIONS[id(device)] = asdict(calibrate(device))
    return CALIBRATIONS[id(device)]


class InProcess:
    """Measures a group when it is sent; the events are received afterwards. failing: what its self-tests find."""

    failing: Mapping[str, str] = MappingProxyType({})

    def __init__(self, want: str, timer: str | None = None):
        self.device = devices.open_device(want)
        calibration = {} if timer else calibration_of(self.device)
        self.timer = timer or calibration["timer"]
        self.events = deque([Ready(self.device.info, self.device.limits, self.timer, calibration)])

    def send(self, request) -> None:
        if isinstance(request, Group):
            bench = Bench(self.device, TIMERS[self.timer](self.device), self.events.append)
            Measuring(bench, catalog()).group(request)
            self.events.append(Ended(bench.split.rounded()))
        elif isinstance(request, Calibrate):
            self.events.append(Calibrated(calibration_of(self.device)))
        elif isinstance(request, SelfTest):
            self.events.append(SelfTested(dict(self.failing)))

    def receive(self, timeout_s: float):
        if not self.events:
            raise Died(("crashed", "nothing was asked for"))
        return self.events.popleft()

    def resident_bytes(self) -> int:
        return 0

    def kill(self, cause) -> None:
        self.events.clear()

    def abandon(self) -> None:
        self.events.clear()

    def close(self) -> None:
        self.events.clear()
