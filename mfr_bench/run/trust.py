"""Whether a run's device passes the self-tests that every result rests on; asked where a cell speaks against it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..errors import DeviceError
from .device_process import DeviceProcess
from .events import Finished, Ready, SelfTested

AGAINST = ("wrong", "crashed")  # statuses that a device which fails such a test gives methods that are right
DOCTOR = "see mfr-bench doctor, and measure again once the device passes"  # ends the reason of every cell it refuses
UNTOLD = ("a cell is {status}, and whether the device is to blame cannot be told: its self-tests did not end; see "
          "mfr-bench doctor")
FAILS = ("{device} fails self-tests without which any image may be wrong: {names}; what is not measured yet is "
         "unsupported; see mfr-bench doctor")


class Trust:
    """The trust in the device of the kind `want`, which lasts until a self-test fails. The device is asked once.

    stop: whether to wait for no answer any more. tell: receives a line where the trust has ended, or cannot be told.
    lacks: the reason why no cell can be measured any more; None while the device is trusted.
    """

    def __init__(self, want: str, stop: Callable[[], bool]):
        self._want, self._stop = want, stop
        self._known = False
        self.tell: Callable[[str], None] = lambda line: None
        self.lacks: str | None = None

    def held(self, finished: Finished, ready: Ready) -> Finished | None:
        """The row of a cell: as it is where the device is trusted, else unsupported; None while that is not known."""
        if finished.status not in AGAINST:
            return finished
        self._known = self._known or self._ask(finished.status, ready)
        if not self._known:
            return None
        return self.refused(finished.key) if self.lacks else finished

    def refused(self, key: str) -> Finished:
        """The row of a cell that a device without trust is not asked to draw."""
        return Finished(key, "unsupported", self.lacks, {})

    def _ask(self, status: str, ready: Ready) -> bool:
        """Run the self-tests in a process of their own. Whether there was time for that."""
        tested = None if self._stop() else self._tested(ready.timer)
        if tested is None and self._stop():
            return False
        if tested is None:
            self.tell(UNTOLD.format(status=status))
        elif tested.failed:
            self.lacks = _reason(tested.failed)
            self.tell(FAILS.format(device=ready.device["renderer"], names=", ".join(tested.failed)))
        return True

    def _tested(self, timer: str) -> SelfTested | None:
        """What a fresh process finds; None where it cannot open the device, dies, or is not to be waited for."""
        fresh = DeviceProcess(self._want, self._stop, timer)
        try:
            fresh.ready()
            return fresh.self_tests()
        except (DeviceError, KeyboardInterrupt):  # the latter where it is to stop before the device is open
            return None
        finally:
            fresh.close(early=True)


def _reason(failed: Mapping[str, str]) -> str:
    """The reason in the words of a feature that fails its trial."""
    first, detail = next(iter(failed.items()))
    more = f" and {len(failed) - 1} more" if len(failed) > 1 else ""
    seen = " ".join(detail.split())
    return f"needs OpenGL as it is specified, which fails the trial {first!r} ({seen}){more}; {DOCTOR}"
