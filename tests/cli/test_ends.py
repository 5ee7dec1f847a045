"""Commands end well when the world fails them: Ctrl-C, a full disk, a reader that leaves, no driver, odd terminals."""

import fcntl
import os
import pty
import re
import resource
import signal
import struct
import subprocess
import termios
import time
from contextlib import suppress
from pathlib import Path

import pytest

from mfr_bench.store import ResultFolder
from mfr_bench.store.journal import Journal

from ..patience import PATIENCE_S
from .conftest import CELLS, FIGURE, TINY, Ended, apart, cells, command, environment, sabotaged

SLOW = """\
name: slow
title: Slow
scene: {size: [64, 48], depth_complexity: 12}
methods: [ab-array, kplus-array]
sweep: {scene.depth_complexity: [8, 12]}
measure: {target_rel_ci: 1.0e-6, min_samples: 6, max_samples: 100000, time_limit_s: 0.2}
"""
SLOW_CELLS = 6
SAMPLES = 150  # of a cell that is to be killed before it has them


def begun(*arguments, **options):
    return subprocess.Popen(command(*arguments), env=environment(), text=True, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, **options)


# --- Ctrl-C --------------------------------------------------------------------------------------


def test_ctrl_c_keeps_what_was_measured_and_a_rerun_goes_on(here):
    (here / "slow.yaml").write_text(SLOW)
    process = begun("run", "slow.yaml", "--out", "out")
    seen = process.stderr.readline()
    assert seen.startswith(f"slow 1/{SLOW_CELLS}"), seen + process.stderr.read()
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    assert out == ""
    kept = cells(here / "out")
    assert any(c["status"] == "ok" for c in kept.values())
    files = {path.name: path.stat().st_mtime_ns for path in (here / "out" / "cells").iterdir()}
    assert err.splitlines()[-1] == (f"interrupted: {len(files)} of {SLOW_CELLS} cells are kept in out; "
                                    "the same command measures the others; mfr-bench table out shows what is there")
    assert not list((here / "out").rglob("*.part"))
    assert "Time, ms" in apart("table", "out").out

    ended = apart("run", "slow.yaml", "--out", "out")
    assert ended.status == 0
    assert f"{SLOW_CELLS} cells: {SLOW_CELLS} ok; {len(files)} kept from before" in ended.out
    assert all((here / "out" / "cells" / name).stat().st_mtime_ns == when for name, when in files.items())


@pytest.mark.parametrize("signal_", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP], ids=lambda s: s.name)
def test_kill_and_a_lost_connection_end_as_ctrl_c_does(here, signal_):
    """The cell over the budget is told as soon as its scene is begun, long before the others are measured."""
    (here / "slow.yaml").write_text(SLOW.replace("kplus-array]", "{id: kplus-array, k: 512}]").replace(
        "time_limit_s: 0.2", "time_limit_s: 60, memory_budget_mb: 5"))
    process = begun("run", "slow.yaml", "--out", "out")
    seen = process.stderr.readline()
    assert "over_budget" in seen, seen + process.stderr.read()
    process.send_signal(signal_)
    _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    complaint = err.splitlines()[-1]
    assert re.match(rf"interrupted: [123] of {SLOW_CELLS} cells are kept in out; ", complaint)
    assert "Traceback" not in err


def processes_below(number):
    """The children of a process, which have groups of their own."""
    found = []
    for entry in Path("/proc").iterdir():
        with suppress(OSError):
            if entry.name.isdecimal() and (entry / "stat").read_text().rpartition(")")[2].split()[1] == str(number):
                found.append(int(entry.name))
    return found


def wait_for_samples(process, journal):
    """Wait until some cell of a run has samples and no row yet."""
    while not any(partial.samples_ms for partial in Journal(journal).partials.values()):
        assert process.poll() is None
        time.sleep(0.005)


def test_a_signal_to_every_process_of_a_job_leaves_no_cell_as_crashed(here):
    (here / "slow.yaml").write_text(SLOW.replace("100000, time_limit_s: 0.2", "100000, time_limit_s: 60"))
    process = begun("run", "slow.yaml", "--out", "out")
    wait_for_samples(process, here / "out" / "unfinished.jsonl")
    for number in processes_below(process.pid):
        os.kill(number, signal.SIGTERM)
    time.sleep(0.5)  # a scheduler reaches one process before the other
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    assert {cell["status"] for cell in cells(here / "out").values()} <= {"ok"}


def test_a_run_that_was_killed_goes_on_within_its_cells(here):
    (here / "slow.yaml").write_text(SLOW.replace("6, max_samples: 100000, time_limit_s: 0.2",
                                                  f"{SAMPLES}, max_samples: {SAMPLES}, time_limit_s: 60"))
    process = begun("run", "slow.yaml", "--out", "out")
    wait_for_samples(process, here / "out" / "unfinished.jsonl")
    process.kill()
    process.communicate()
    journal = here / "out" / "unfinished.jsonl"
    before = Journal(journal).partials

    assert apart("run", "slow.yaml", "--out", "out").status == 0
    after = {cell["key"]: cell for cell in ResultFolder(here / "out").cells()}
    assert len(after) == SLOW_CELLS
    for key, partial in before.items():
        assert partial.samples_ms == [] or after[key]["values"]["sessions"] == 2
        assert after[key]["samples_ms"][:len(partial.samples_ms)] == partial.samples_ms
    assert all(len(cell["samples_ms"]) == cell["values"]["samples"] == SAMPLES for cell in after.values())
    assert not journal.exists()


# --- a full disk ---------------------------------------------------------------------------------


@pytest.fixture
def small_disk(here):
    """A file system of four pages, of which the manifest and each cell take one; it can grow."""
    disk = here / "disk"
    disk.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "none", disk], capture_output=True, check=False)
    if mounted.returncode:
        pytest.skip("mounting a small file system needs more rights; the limit on files below is tested instead")
    yield disk
    subprocess.run(["umount", disk], check=True)


def test_a_full_disk_is_one_line_and_keeps_what_was_written(small_disk, tiny):
    ended = apart("run", tiny, "--out", "disk/out")
    assert ended.status == 1
    *_, complaint = ended.err.splitlines()
    assert re.fullmatch(r"disk/out/\S+: cannot be written: No space left on device; free some space or choose another "
                        r"folder, then run the same command again: what is written stays", complaint)
    assert "Traceback" not in ended.err
    kept = len(cells(small_disk / "out"))
    assert 0 < kept < CELLS
    assert not list(small_disk.rglob("*.part"))

    subprocess.run(["mount", "-o", "remount,size=4m", small_disk], check=True)
    ended = apart("run", tiny, "--out", "disk/out")
    assert ended.status == 0
    assert f"{CELLS} cells: {CELLS} ok; {kept} kept" in ended.out


def test_a_limit_on_files_is_one_line(tiny, here):
    tiny.write_text(TINY + FIGURE)
    ended = apart("run", tiny, "--out", "out",
                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (6000, 6000)))
    assert ended.status == 1
    assert re.match(r"out/\S+: cannot be written: File too large; free some space", ended.err.splitlines()[-1])
    assert "Time, ms" in ended.out
    assert len(cells(here / "out")) == CELLS


# --- output that nobody takes --------------------------------------------------------------------


def through(line: str, **options) -> Ended:
    """A line of bash in which $MFR is the command; its status is the command's, not the last of the pipe's."""
    done = subprocess.run(["bash", "-c", f"set -o pipefail; {line}"], capture_output=True, text=True, check=False,
                          timeout=PATIENCE_S, env=environment(MFR=" ".join(command())), **options)
    return Ended(done.returncode, done.stdout, done.stderr)


@pytest.mark.parametrize("arguments", ["methods --json", "shader kplus-array", "configs"])
def test_a_reader_that_leaves_is_no_error(arguments):
    assert through(f"$MFR {arguments} | true") == Ended(0, "", "")


def test_a_reader_that_leaves_costs_no_cell(tiny, here):
    ended = through("$MFR run tiny.yaml --out out 2>&1 | head -1")
    assert (ended.status, ended.err) == (0, "")
    assert ended.out.startswith(f"tiny 1/{CELLS}")
    assert [cell["status"] for cell in cells(here / "out").values()] == ["ok"] * CELLS


def test_closed_streams_are_no_error(tiny, here):
    assert through("$MFR run tiny.yaml --out out --only floor >&- 2>&-") == Ended(0, "", "")
    found, = cells(here / "out").values()
    assert found["status"] == "ok"


def test_an_output_that_cannot_be_written_is_one_line():
    ended = through("$MFR configs > /dev/full")
    assert ended.status == 1
    assert ended.complaint == "the output: No space left on device"


def test_characters_that_an_encoding_lacks_are_no_error(tiny):
    ended = apart("run", tiny, "--out", "out", "--only", "floor", env={"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"})
    assert ended.status == 0
    assert "Time, ms" in ended.out


# --- no driver -----------------------------------------------------------------------------------

INSTALL = "install a driver: sudo apt-get install -y libegl1 libgl1 libgl1-mesa-dri"


@pytest.fixture(params=["no vendor", "no library"])
def no_driver(request, here):
    """Environments without OpenGL: glvnd finds no driver, or EGL cannot be loaded at all."""
    if request.param == "no vendor":
        return {"__EGL_VENDOR_LIBRARY_FILENAMES": str(here / "none.json")}
    (here / "lib").mkdir()
    for name in ("libEGL.so.1", "libEGL.so"):
        (here / "lib" / name).write_text("")
    return {"LD_LIBRARY_PATH": str(here / "lib")}


@pytest.mark.parametrize("arguments", [["run", "tiny.yaml", "--out", "out"], ["doctor"]], ids=" ".join)
def test_no_driver_is_one_line_with_what_to_install(tiny, here, no_driver, arguments):
    ended = apart(*arguments, env=no_driver)
    assert ended.status == 1
    assert ended.complaint.startswith("no OpenGL 4.3 device: ")
    assert ended.complaint.endswith(INSTALL)
    assert not (here / "out").exists()


def test_without_a_driver_methods_and_plans_are_still_told(tiny, no_driver):
    ended = apart("methods", env=no_driver)
    assert ended.status == 0
    assert "no device to run it on" in ended.out
    assert ended.err.splitlines()[-1].endswith(INSTALL)
    ended = apart("run", tiny, "--dry-run", env=no_driver)
    assert ended.status == 0
    assert ended.out.endswith(f"{CELLS} to measure, 0 not\n")
    assert ended.err.count(INSTALL) == 1


# --- terminals -----------------------------------------------------------------------------------


BROKEN = """
from mfr_bench.glsl import includes
real = includes.read
includes.read = lambda p: real(p).replace("void main() {", "void main() { oops;") if "array/store" in p else real(p)
"""


def on_terminal(*arguments, columns=80, **env) -> tuple[int, str, str]:
    """Exit status, stdout, and what a terminal on stderr received."""
    terminal, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    process = subprocess.Popen(command(*arguments), env=environment(TERM="xterm-256color") | env,
                               stdout=subprocess.PIPE, stderr=slave, text=True)
    os.close(slave)
    received = b""
    while chunk := _read(terminal):
        received += chunk
    os.close(terminal)
    out = process.stdout.read()
    return process.wait(timeout=PATIENCE_S), out, received.decode()


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 4096)
    except OSError:  # Linux says so when the other end is closed
        return b""


def plain(text: str) -> list[str]:
    """The lines that a terminal was sent, without cursor movements and colours."""
    return [line for line in re.split(r"[\r\n]+", re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "\r", text)) if line.strip()]


@pytest.mark.parametrize("columns", [40, 120])
def test_a_terminal_sees_one_live_line(tiny, columns):
    status, out, received = on_terminal("run", tiny, "--out", "out", columns=columns)
    assert status == 0
    assert f"{CELLS} cells: {CELLS} ok" in out
    lines = plain(received)
    assert re.match(rf"\d+ s  tiny 0/{CELLS}  starting", lines[0])
    foretold = rf"\d+ s  tiny 0/{CELLS}, forecast: \d+ s left  starting"
    foretold = foretold if columns > 40 else foretold.replace("starting", "s\\w*…")
    assert any(re.match(foretold, line) for line in lines)
    assert all(re.match(rf"\d+ s  tiny [0-{CELLS}]/{CELLS}", line) and len(line) <= columns for line in lines)
    assert "\x1b[?25h" in received.rpartition("\x1b[?25l")[2]  # the cursor is back


def test_what_failed_stays_on_the_terminal(tiny, here):
    status, _, received = on_terminal("run", tiny, "--out", "out", columns=300, **sabotaged(here / "broken", BROKEN))
    assert status == 1
    failed, = {line for line in plain(received) if line.startswith("AB_Array: crashed")}
    assert "methods/array/store.frag" in failed


@pytest.mark.parametrize("env", [{"TERM": "dumb"}, {"NO_COLOR": "1"}], ids=str)
def test_colours_are_never_forced(tiny, env):
    status, _, received = on_terminal("run", tiny, "--out", "out", "--only", "floor", **env)
    assert status == 0
    assert not re.search(r"\x1b\[[0-9;]*[1-9][0-9;]*m", received)
    if env == {"TERM": "dumb"}:
        assert "\x1b" not in received
        assert received.startswith("tiny 1/1")
