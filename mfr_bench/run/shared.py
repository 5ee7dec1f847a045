"""Arrays that one process writes once and others read where they are: memory without a name in any file system."""

from __future__ import annotations

import itertools
import mmap
import os
from typing import Protocol

import numpy as np

NUMBERS = itertools.count()  # of the arrays of this process


class Array(Protocol):
    """An array for work beside the device. name: tells it from every other of the run."""

    bytes: int
    name: tuple[int, int]

    def array(self) -> np.ndarray:
        """The array; one that another process has written cannot be changed."""

    def release(self) -> None:
        """Let the memory go; nothing asks for the array afterwards."""


class Held:
    """An array of this process, for work in this process."""

    def __init__(self, array: np.ndarray):
        self._array, self.bytes, self.name = array, array.nbytes, (os.getpid(), next(NUMBERS))

    def array(self) -> np.ndarray:
        return self._array

    def release(self) -> None:
        self._array = None


class Unreachable(Exception):  # noqa: N818 - what happened
    """The process that wrote the array has let it go, or has ended."""


class Shared:
    """A copy of an array that pickles as the place where it is. The process that made it holds it until `release`.

    The memory is no file of /dev/shm, which is 64 MiB large in many containers. Raises MemoryError where there is none.
    """

    def __init__(self, array: np.ndarray):
        self._shape, self._type, self.bytes = array.shape, array.dtype.str, array.nbytes
        self.name, self._handle = (os.getpid(), next(NUMBERS)), -1
        left = memoryview(np.ascontiguousarray(array)).cast("B") if array.nbytes else b""
        try:
            self._handle = os.memfd_create("array")
            while left:  # by calls that fail where memory runs out: a write to mapped memory would end the process
                left = left[os.write(self._handle, left):]
        except OSError as error:
            self.release()
            raise MemoryError(f"no memory to share {self.bytes} bytes: {error.strerror}") from error

    def array(self) -> np.ndarray:
        """The array, mapped. Raises Unreachable."""
        if self._handle < 0:
            raise Unreachable("the array was released")
        if not self.bytes:
            return np.empty(self._shape, self._type)
        handle = self._handle if self._mine else self._opened()
        try:
            mapped = mmap.mmap(handle, self.bytes, prot=mmap.PROT_READ)
        except (OSError, ValueError) as error:
            raise Unreachable(str(error)) from error
        finally:
            if not self._mine:
                os.close(handle)
        return np.frombuffer(mapped, self._type).reshape(self._shape)

    def release(self) -> None:
        """Let the memory go, once nobody maps it any more."""
        if self._handle >= 0 and self._mine:
            os.close(self._handle)
        self._handle = -1

    @property
    def _mine(self) -> bool:
        return self.name[0] == os.getpid()

    def _opened(self) -> int:
        try:
            return os.open(f"/proc/{self.name[0]}/fd/{self._handle}", os.O_RDONLY | os.O_CLOEXEC)
        except OSError as error:
            raise Unreachable(str(error)) from error
