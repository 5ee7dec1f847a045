"""Two ways to begin a process that serves this one: a new one, or one that has stood by since before the device."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

from .parent import live_for

END_S = 1.0  # for a process that was killed: a driver may hold it in the kernel
Serve = Callable[..., None]  # in the other process: takes its end of the link, the parent's id, and what is given


def new(serve: Serve, *given: object) -> tuple[BaseProcess, Connection]:
    """A process that begins with nothing, and imports what it serves. Raises OSError where there can be none."""
    return _begun("spawn", serve, *given)


class Standby:
    """A process that has all that this one had imported when it began, and then waits to be told what to serve.

    A copy of a process that has a device or threads of a driver would share them, so it begins before there are any:
    it costs 2 ms then, where a new one takes half a second of processor time to import as much. A context: leaving it
    ends the process, for which Python would else wait at its own end.
    """

    def __init__(self) -> None:
        self._process: BaseProcess | None = None
        with suppress(OSError), warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of threads, which are those of numpy, at rest
            self._process, self._link = _begun("fork", _serve_what_is_told)

    def begin(self, serve: Serve, *given: object) -> tuple[BaseProcess, Connection]:
        """The process, which now serves. Raises OSError where it is gone."""
        if self._process is None:
            raise BrokenPipeError
        self._link.send((serve, given))
        return self._process, self._link

    def __enter__(self):
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def end(self) -> None:
        """End the process, whatever it is at."""
        if self._process is not None:
            self._process.kill()
            self._process.join(END_S)
            self._link.close()
            self._process = None


def _begun(how: str, serve: Serve, *given: object) -> tuple[BaseProcess, Connection]:
    context = get_context(how)
    ours, theirs = context.Pipe()
    process = context.Process(target=serve, args=(theirs, os.getpid(), *given), daemon=True)
    with theirs:
        process.start()
    return process, ours


def _serve_what_is_told(link: Connection, parent: int) -> None:
    """Wait to be told, then serve."""
    live_for(parent)
    with suppress(EOFError):
        serve, given = link.recv()
        serve(link, parent, *given)
