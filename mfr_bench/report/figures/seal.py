"""The parts of a figure's files, and checksums by which one that was damaged after it was drawn is known.

The chunks of a PNG file have theirs by its format; an SVG file gets one as a comment at its end.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Mapping

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
SAID, SAID_ROWS = "Description", "Description-Rows"  # texts of a PNG: the small print, and how many rows show it
AROUND = 12  # bytes of a chunk that are not content: its length, kind and checksum


def chunk(kind: bytes, content: bytes) -> bytes:
    """A part of a PNG file: its length, kind, content and checksum."""
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def sealed_svg(content: bytes) -> bytes:
    """An SVG file with its checksum."""
    return content + b"<!-- crc32 of the lines above: %08x -->\n" % zlib.crc32(content)


def _whole_svg(content: bytes) -> bool:
    end = content.rfind(b"<!--")
    return end > 0 and content == sealed_svg(content[:end])


def _whole_png(content: bytes) -> bool:
    """Whether each byte belongs to a chunk with its checksum, of which the last is the one that ends every file."""
    at, last = len(PNG_SIGNATURE), b""
    while at + AROUND <= len(content):
        length, last = struct.unpack_from(">I4s", content, at)
        held = content[at + 8:at + 8 + length]
        if not content.startswith(chunk(last, held), at):
            return False
        at += AROUND + length
    return content.startswith(PNG_SIGNATURE) and at == len(content) and last == b"IEND"


WHOLE: Mapping[str, Callable[[bytes], bool]] = {".png": _whole_png, ".svg": _whole_svg}
