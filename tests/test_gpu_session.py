"""The script for some minutes of a GPU: its parts in order, within its time, and on again after it was cut off."""

import os
import re
import signal
import subprocess
from pathlib import Path

import pytest

from .patience import PATIENCE_S, until

ROOT = Path(__file__).resolve().parent.parent
SCRIPT = ROOT / "scripts" / "gpu-session.sh"
PARTS = ("doctor", "tests", "conformance", "races", "race", "kplus", "lists", "others", "claims", "pack",
         "bundle", "verify")


@pytest.fixture
def session(tmp_path):
    """Starts the script with commands that keep what they are asked, run STUB of the environment, and say `done`."""
    stub = tmp_path / "stub"
    stub.write_text(f'#!/bin/sh\necho "$@" >>{tmp_path}/asked\n'
                    f'[ "$1" != submit-results ] || echo zip >{tmp_path}/results/bundle.zip\n'
                    'eval "${STUB:-true}" || exit $?\necho done\n')
    stub.chmod(0o755)

    def start(total, stub_code="true", **more):
        return subprocess.Popen(["sh", SCRIPT, total, tmp_path / "results"], stdout=subprocess.PIPE, text=True,
                                stderr=subprocess.STDOUT, start_new_session=True,
                                env=os.environ | {"MFR": str(stub), "PYTHON": str(stub), "STUB": stub_code} | more)
    start.asked = lambda: (tmp_path / "asked").read_text().splitlines()
    start.folder = tmp_path / "results"
    return start


def parts(output):
    return [line.split()[1].rstrip(":") for line in output.splitlines() if ": status" in line or ": cut" in line]


def test_every_part_runs_in_order_and_each_measures_within_its_share(session):
    run = session("200s", DEVICE="cpu", PROFILE="smoke")
    output = run.communicate()[0]
    assert run.returncode == 0, output
    assert tuple(parts(output)) == PARTS
    asked = session.asked()
    budgets = {line.split()[1]: line.rpartition(" ")[2] for line in asked if "--time-budget" in line}
    assert budgets["device-features"] == "50s" and budgets["races"] == "20s"  # 25 % and 10 % of 200 s
    assert all("--device cpu" in line for line in asked if "--time-budget" in line)
    assert all("--profile smoke" in line for line in asked if line.startswith("run "))
    assert re.fullmatch(r"== [\d.]+K in \S+, [\d.]+K of it bundle.zip, after \d+ s of 200 s", output.splitlines()[-1])
    again = session("200s", DEVICE="cpu").communicate()[0]
    assert [line for line in again.splitlines() if "before" in line] == ["== tests: passed before"]


def test_a_part_that_fails_fails_the_script_and_stops_none(session):
    run = session("200s", 'case "$1" in claims) exit 4 ;; esac')
    output = run.communicate()[0]
    assert run.returncode == 1
    assert "== claims: status 4" in output
    assert tuple(parts(output)) == PARTS


def test_what_finds_no_time_is_said_to_be_left_out(session):
    output = session("30s", 'case "$1" in doctor) sleep 1 ;; esac').communicate()[0]
    assert "== races: left out, no time" in output
    assert "== claims: status 0" in output


def test_cells_without_time_are_counted(session):
    output = session("100s", """case "$2" in kplus*) for n in 40 2; do
        echo "left out for the time budget: $n cells (KB 40); the same command measures them"; done ;; esac""")
    assert re.search(r"== kplus: status 0 after \d+ s, \d+ s left; 42 cells left out; done", output.communicate()[0])


def test_a_session_that_is_cut_off_ends_what_it_started(session, tmp_path):
    run = session("100s", f'case "$2" in device-features) echo $$ >{tmp_path}/pid; exec sleep 60 ;; esac')
    said = tmp_path / "pid"
    until(lambda: said.exists() and said.read_text().strip(), "no part measures")
    measuring = int(said.read_text())
    run.send_signal(signal.SIGTERM)
    output = run.communicate(timeout=PATIENCE_S)[0]
    assert run.returncode == 143
    assert "== cut off after" in output and "goes on" in output
    with pytest.raises(ProcessLookupError):
        os.kill(measuring, 0)


def test_a_forecast_asks_for_the_plan_of_every_part_that_measures_and_runs_none(session):
    run = session("forecast", """case "$1 $2" in
        "stress races") echo "  predicted: about 9 s; frame times: 2" ;;
        "run device-features") exit 3 ;;
        run*) printf '  predicted: about 1 s\n\n12 cells to measure in all: about 40 s\n' ;;
    esac""", PROFILE="smoke")
    output = run.communicate()[0]
    assert run.returncode == 1  # the first plan failed
    assert output.splitlines() == ["== races: about 9 s; frame times: 2",
                                   *(f"== {part}: about 40 s" for part in ("kplus", "lists", "others"))]
    assert all("--dry-run" in line and "--time-budget" not in line for line in session.asked())


@pytest.mark.parametrize("total", ["8", "m", "-3m", "8m30s", "0m", "08m"])
def test_a_time_that_is_none_is_refused(session, total):
    run = session(total)
    output = run.communicate()[0]
    assert run.returncode == 2
    assert "allowed: a whole number" in output and len(output.splitlines()) == 1
