"""`python -m mfr_bench.gpu.probe`: is there an OpenGL device? Exit status 0, or 3 with what to install."""

from __future__ import annotations

import sys

from ..errors import DeviceError
from .device import open_device


def main() -> int:
    try:
        info = open_device().info
    except DeviceError as error:
        print(error, file=sys.stderr)
        return 3
    print(f"OpenGL {info['version']} on {info['renderer']}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
