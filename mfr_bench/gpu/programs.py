"""Keeps the programs linked on a device that are in use or were used last, and deletes the others."""

from __future__ import annotations

import weakref
from collections import OrderedDict
from collections.abc import Callable, Iterator

# Programs kept beside those in use. A scene of `conformance` takes 302: where fewer are kept, each scene compiles all
# of them again. One takes 1 to 4 MiB of llvmpipe; a layered driver has its own of it too, 2.5 GiB for 256 on zink.
MOST, MOST_LAYERED = 512, 256


class Programs:
    """Linked programs by the code of their stages. most: how many are kept that nothing may be using.

    A program that nothing uses any more is deleted before another is linked: by then the device's context is current.
    """

    def __init__(self, most: int = MOST):
        self._most = most
        self._there: weakref.WeakValueDictionary[tuple[str, ...], object] = weakref.WeakValueDictionary()
        self._recent: OrderedDict[tuple[str, ...], object] = OrderedDict()
        self._unused: list[object] = []

    def __len__(self) -> int:
        return len(self._there)

    def __iter__(self) -> Iterator[tuple[str, ...]]:
        return iter(self._there)

    def get(self, code: tuple[str, ...], link: Callable[[], object]) -> object:
        """The program of these stages; `link` makes it where it is not kept."""
        program = self._there.get(code)
        if program is None:
            self._delete_unused()
            program = self._there[code] = link()
            weakref.finalize(program, self._unused.append, program.mglo).atexit = False
        self._recent[code] = program
        self._recent.move_to_end(code)
        while len(self._recent) > self._most:
            self._recent.popitem(last=False)
        return program

    def _delete_unused(self) -> None:
        while self._unused:
            self._unused.pop().release()
