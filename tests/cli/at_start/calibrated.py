"""Lets the processes that measure calibrate each device once for all commands of the tests.

Imported when a process starts. What the first process found is kept in the folder that MFR_BENCH_CALIBRATIONS names.
"""

import os
import pickle
import sys
import zlib
from dataclasses import replace
from pathlib import Path

if any("run.worker" in argument for argument in sys.orig_argv):
    from mfr_bench.gpu import selftest

    measured = selftest.calibrate

    def calibrate(device, again=False):
        """What the device's calibration found, by this process or by one before; without rates where made again."""
        found = Path(os.environ["MFR_BENCH_CALIBRATIONS"]) / f"{zlib.crc32(repr(device.info).encode())}.pickle"
        if not found.is_file():
            part = found.with_suffix(f".{os.getpid()}")
            part.write_bytes(pickle.dumps(measured(device)))
            part.replace(found)
        made = pickle.loads(found.read_bytes())  # noqa: S301 - a process of the same tests has written it
        return replace(made, rates={}) if again else made

    selftest.calibrate = calibrate
