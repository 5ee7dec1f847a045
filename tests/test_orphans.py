"""Processes that work for another one end with it, however it ends."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mfr_bench.methods import outside

from .cli.conftest import environment
from .patience import until

FOREVER = "import os, pathlib, time\npathlib.Path({path!r}).joinpath(str(os.getpid())).touch()\ntime.sleep(600)\n"
POOL = """
import os, pathlib, time
from mfr_bench.parallel import in_processes

def work(item):
    pathlib.Path({path!r}).joinpath(str(os.getpid())).touch()
    time.sleep(600)

if __name__ == "__main__":
    list(in_processes(work, range(6), 2))
"""


def gone(pid: int) -> bool:
    """Whether a process has ended, be it that nobody has asked for its status yet."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except FileNotFoundError:
        return True


@pytest.mark.parametrize(("program", "count"), [
    (POOL, 2), ("from mfr_bench.methods import outside; outside.loaded()", 1)], ids=["pool", "methods from outside"])
@pytest.mark.parametrize("ending", ["terminate", "kill"])
def test_no_process_outlives_the_one_that_it_works_for(program, count, ending, tmp_path):
    at_work, folder = tmp_path / "at_work", tmp_path / "methods"
    at_work.mkdir()
    folder.mkdir()
    (folder / "endless.py").write_text(FOREVER.format(path=str(at_work)))
    (tmp_path / "program.py").write_text(program.format(path=str(at_work)))
    process = subprocess.Popen([sys.executable, str(tmp_path / "program.py")],
                               env=environment(**{outside.VARIABLE: str(folder)}))
    try:
        until(lambda: len(list(at_work.iterdir())) >= count or process.poll() is not None, "no process is at work")
        found = [int(path.name) for path in at_work.iterdir()]
        assert len(found) == count and process.poll() is None
    finally:
        getattr(process, ending)()
        process.wait()
    until(lambda: all(map(gone, found)), "a process outlives the one that it works for")
