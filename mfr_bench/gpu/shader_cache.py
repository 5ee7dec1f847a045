"""Keeps Mesa from its cache of programs where the disk has no room for it.

Mesa 22.3 maps the index of its cache into memory without reserving the file's blocks. Where the file system is full, or
a quota used up, the kernel ends the process by SIGBUS when a program is added.
"""

from __future__ import annotations

import errno
import os
import pwd
import tempfile
from contextlib import suppress
from pathlib import Path

from ..environment import MIB

VARIABLE, OFF = "MESA_SHADER_CACHE_DISABLE", "true"
ROOM_BYTES = 2 * MIB  # the index takes 1.25 MiB
FULL = (errno.ENOSPC, errno.EDQUOT)


def avoid_full_cache() -> None:
    """Set Mesa's variable for this process and those that it starts, where it is needed; before a driver is loaded.

    A value that the user has given stays.
    """
    if VARIABLE not in os.environ and not has_room(cache_folder()):
        os.environ[VARIABLE] = OFF


def cache_folder() -> Path:
    """The folder in which Mesa keeps its cache."""
    home = Path("/")
    with suppress(KeyError):  # a user without an entry, as in containers
        home = Path(pwd.getpwuid(os.getuid()).pw_dir)
    given = os.environ.get("MESA_SHADER_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME")
    return Path(given) if given else home / ".cache"


def has_room(folder: Path) -> bool:
    """Whether the file system of a folder, which need not exist yet, has blocks left for the cache.

    True also where nothing can be written: there Mesa goes without a cache by itself.
    """
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.is_dir())
    try:
        with tempfile.TemporaryFile(dir=there) as file:
            os.posix_fallocate(file.fileno(), 0, ROOM_BYTES)
    except OSError as error:
        return error.errno not in FULL
    return True
