"""Workers that act out what goes wrong, and a supervisor that has them; no process, no device, no time."""

from __future__ import annotations

import pickle

from mfr_bench.config.model import Measure, Scene
from mfr_bench.methods import catalog
from mfr_bench.plan import Cell
from mfr_bench.run import device_process as processes
from mfr_bench.run import trust
from mfr_bench.run.events import Begun, Ended, Finished, Group, Ready, Sampled, SelfTest, SelfTested, Synced
from mfr_bench.run.jobs import jobs
from mfr_bench.run.ledger import Ledger
from mfr_bench.run.process import Died
from mfr_bench.run.sheet import Sheet
from mfr_bench.run.supervisor import Supervisor
from mfr_bench.store import ResultFolder

from .fake_worker import DEVICE

READY = Ready(DEVICE, None, "wall", {"timer": "wall"})
CRASH = ("crashed", "killed by SIGSEGV")


def cell(method, n=4, measure=None, **params):
    return Cell("test", method, method, catalog()[method].complete(params), Scene(size=(8, 8), depth_complexity=n),
                measure or Measure(), {})


class Actor:
    """A worker that plays a script: events, causes of its death, and functions of the group that give more of both.

    It plays it for every group, and where it is to test itself.
    """

    def __init__(self, script, opening=READY):
        self.script, self.opening, self.events = script, opening, [opening]
        self.sent, self.killed, self.held, self.closed = [], None, 0, False

    def send(self, request):
        request = pickle.loads(pickle.dumps(request))  # noqa: S301 - as between processes
        self.sent.append(request)
        if isinstance(request, (Group, SelfTest)):
            self.events += self.script(request)

    def receive(self, timeout_s):
        if not self.events:
            if self.killed:
                raise Died(self.killed)
            return None
        event = self.events.pop(0)
        if isinstance(event, tuple):
            raise Died(event)
        return event() if callable(event) else event

    def resident_bytes(self):
        return self.held

    def kill(self, cause):
        self.killed = self.killed or cause

    def abandon(self):
        self.killed = self.killed or ("crashed", "abandoned")

    def close(self):
        self.closed = True


def finished(job, time_ms=1.0):
    return Finished(job.key, "ok", None, {"time_ms": time_ms, "timer": "wall"}, {"samples_ms": [time_ms]})


def well(group, taken=3):
    """Everything as it should be: in turns, then the rows."""
    sampled = [event for job in group.jobs for event in
               (Begun(job.key, "sampling"), Sampled(job.key, (1.0,) * taken), Synced())]
    rows = [event for job in group.jobs for event in (Begun(job.key, "passes"), finished(job), Synced())]
    return [*sampled, *rows, Ended({})]


class Stage:
    """A supervisor whose workers are actors, and its ledger. tester: the worker that tests the device, if it is asked.

    lines: what the supervisor tells. tests: how often the device was tested.
    """

    def __init__(self, folder, monkeypatch, cells, *actors, asked=lambda: False, tester=None, **more):
        self.actors, waiting = actors, list(actors)
        self.lines, self.tests = [], 0

        def fresh(*given):
            self.tests += 1
            waiting.insert(0, tester or Actor(lambda _: [SelfTested({})]))
            return processes.DeviceProcess(*given)

        monkeypatch.setattr(trust, "DeviceProcess", fresh)
        monkeypatch.setattr(processes, "Worker", lambda want, timer=None: waiting.pop(0))
        monkeypatch.setattr(processes, "PAUSE_S", 0)
        self.sheet = Sheet(ResultFolder(folder), jobs(cells, catalog(), DEVICE, "wall"))
        self.ledger = Ledger([self.sheet], DEVICE)
        self.ledger.settle()
        with Supervisor("auto", asked) as supervisor:
            supervisor.measure(self.ledger.groups(), self.ledger, tell=self.lines.append, **more)
        self.ledger.close()

    def rows(self):
        return {(c["method"], c["scene"]["depth_complexity"]): c for c in self.sheet.folder.cells()}


CELLS = [cell("floor"), cell("ab-array"), cell("kplus-array", k=2)]
