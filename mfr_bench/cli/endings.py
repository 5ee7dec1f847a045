"""The exit statuses that commands choose themselves; `errors` has those of mistakes and interruptions.

And whether the device is to blame where one of them says that an image is wrong.
"""

from __future__ import annotations

from .output import note

UNTOLD = 1  # the time ended, or the device failed its self-tests, before anything could be told
WRONG = 3  # an image is wrong, a promise is broken, or a bundle is odd
REGRESSION = 4  # something is slower, or newly wrong
DOUBT = 5  # nothing could be told, or cells are missing
NOTHING_KEEPS = 6  # no method keeps the bounds


def note_blame(device: str, what: str) -> None:
    """Say on stderr where a device of this kind fails its self-tests. what: the words for what is not right."""
    from ..run.trust import blame

    if line := blame(device, what):
        note(line)
