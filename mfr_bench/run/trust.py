"""Whether a device passes the self-tests that every result rests on; asked where an image speaks against it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..errors import DeviceError
from .device_process import DeviceProcess
from .events import Finished, Ready, SelfTested

AGAINST = ("wrong", "crashed")  # statuses that a device which fails such a test gives methods that are right
UNTOLD = ("{what}, and whether the device is to blame cannot be told: its self-tests did not end; see "
          "mfr-bench doctor")
FAILS = "{device} fails self-tests without which any image may be wrong: {names}; {so}; see mfr-bench doctor"

Tested = tuple[Ready, SelfTested]  # the device, and what its self-tests found


class Trust:
    """The trust in the device of the kind `want`, which lasts until a self-test fails. The device is asked once.

    stop: whether to wait for no answer any more. tell: receives a line where the trust has ended, or cannot be told.
    failed: what each self-test that the device fails has seen, by its name: no cell can be measured any more.
    """

    def __init__(self, want: str, stop: Callable[[], bool]):
        self._want, self._stop = want, stop
        self._known = False
        self.tell: Callable[[str], None] = lambda line: None
        self.failed: Mapping[str, str] = {}

    def held(self, finished: Finished, ready: Ready) -> Finished | None:
        """The row of a cell: as it is where the device is trusted, else unsupported; None while that is not known."""
        if finished.status not in AGAINST:
            return finished
        self._known = self._known or self._ask(finished.status, ready)
        if not self._known:
            return None
        return self.refused(finished.key) if self.failed else finished

    def refused(self, key: str) -> Finished:
        """The row of a cell that a device without trust is not asked to draw."""
        return Finished(key, "unsupported", _reason(self.failed), {}, failed_trials=tuple(self.failed))

    def _ask(self, status: str, ready: Ready) -> bool:
        """Run the self-tests in a process of their own. Whether there was time for that."""
        tested = None if self._stop() else self._tested(ready.timer)
        if tested is None and self._stop():
            return False
        if line := _told(tested, f"a cell is {status}", "what is not measured yet is unsupported"):
            self.tell(line)
        if tested:
            self.failed = tested[1].failed
        return True

    def _tested(self, timer: str) -> Tested | None:
        try:
            return _tested(self._want, self._stop, timer)
        except KeyboardInterrupt:  # where it is to stop before the device is open
            return None


def blame(want: str, what: str) -> str | None:
    """A line where the device is to blame for what is not right, or where that cannot be told; else None.

    want: the kind of device. what: the words for what is not right. A process of its own runs the self-tests.
    """
    return _told(_tested(want, lambda: False, "wall"), what, "its images prove nothing")


def _tested(want: str, stop: Callable[[], bool], timer: str) -> Tested | None:
    """What a fresh process finds; None where it cannot open the device, dies, or is not to be waited for.

    Raises KeyboardInterrupt where it is to stop before the device is open.
    """
    fresh = DeviceProcess(want, stop, timer)
    try:
        ready, found = fresh.ready(), fresh.self_tests()
        return (ready, found) if found else None
    except DeviceError:
        return None
    finally:
        fresh.close(early=True)


def _told(tested: Tested | None, what: str, so: str) -> str | None:
    """The line on what the self-tests found; None where the device passes. so: what follows where it fails."""
    if tested is None:
        return UNTOLD.format(what=what)
    ready, found = tested
    failed = ", ".join(found.failed)
    return FAILS.format(device=ready.device["renderer"], names=failed, so=so) if failed else None


def _reason(failed: Mapping[str, str]) -> str:
    """The reason in the words of a feature that fails its trial."""
    first, detail = next(iter(failed.items()))
    more = f" and {len(failed) - 1} more" if len(failed) > 1 else ""
    seen = " ".join(detail.split())
    return (f"needs OpenGL as it is specified, which fails the trial {first!r} ({seen}){more}; see mfr-bench doctor, "
            "and measure again once the device passes")
