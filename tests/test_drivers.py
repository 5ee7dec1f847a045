"""The matrix of drivers: what runs again, what is told, and the workflow that runs it."""

import dataclasses
import importlib.util
import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import ending
import pytest
import yaml

from .patience import until

ROOT = Path(__file__).resolve().parent.parent
WORKFLOW = ROOT / ".github" / "workflows" / "drivers.yml"


@pytest.fixture
def drivers(monkeypatch):
    """The script as a module, whose scripts run here instead of in a root."""
    spec = importlib.util.spec_from_file_location("drivers", ROOT / "scripts" / "drivers.py")
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "drivers", module)
    spec.loader.exec_module(module)
    module.entering = module.Matrix._inside
    monkeypatch.setattr(module.Matrix, "_inside", lambda self, root, script: ["bash", "-c", script.replace(
        "cd /mfr-bench", f"cd {self.folder}")])
    monkeypatch.setattr(module.Matrix, "_copy_sources", lambda self, root: None)
    return module


@pytest.fixture
def matrix(drivers, tmp_path):
    """A matrix with one root that was made before, in which `make setup` succeeds."""
    (tmp_path / "sid.ready").touch()
    (tmp_path / "Makefile").write_text("setup:\n\t@echo set up\n")
    return drivers.Matrix(tmp_path)


def statuses(matrix, *checks):
    return [matrix.outcome("sid", "llvmpipe", check).get("status") for check in checks]


def test_a_check_that_ended_runs_again_when_the_sources_change(drivers, matrix, monkeypatch):
    ran = matrix.folder / "ran"
    monkeypatch.setitem(drivers.CHECKS, "doctor", drivers.Check(f"echo once >>{ran}; false", 20))
    for _ in range(2):
        matrix.run("sid", "llvmpipe", ["doctor"], again=False)
    assert statuses(matrix, "doctor") == [1]
    assert ran.read_text() == "once\n"
    matrix.stamp = "other"
    matrix.run("sid", "llvmpipe", ["doctor"], again=False)
    matrix.run("sid", "llvmpipe", ["doctor"], again=True)
    assert ran.read_text() == "once\n" * 3


def test_the_table_tells_how_each_check_ended(drivers, matrix, monkeypatch):
    for check, command, limit_s in (("doctor", "true", 20), ("smoke", "exit 4", 20), ("stress", "sleep 20", 1)):
        monkeypatch.setitem(drivers.CHECKS, check, drivers.Check(command, limit_s))
    matrix.run("sid", "llvmpipe", ["doctor", "smoke", "stress"], again=False)
    assert statuses(matrix, "doctor", "smoke", "stress", "features") == [0, 4, 124, None]
    row = drivers.table(matrix, ["sid"], ["llvmpipe"], ["doctor", "smoke", "stress", "features"]).splitlines()[-1]
    cells = [cell.strip().partition(",")[0] for cell in row.strip("|").split("|")]
    assert cells == ["sid", "llvmpipe", "pass", "FAIL (4)", "timeout", "not run"]


def test_a_root_that_cannot_be_set_up_fails_no_check(drivers, matrix):
    (matrix.folder / "Makefile").write_text("setup:\n\t@false\n")
    matrix.run("sid", "llvmpipe", ["doctor", "conformance"], again=False)
    assert statuses(matrix, "doctor", "conformance") == [drivers.NO_SETUP] * 2
    assert "not set up" in drivers.table(matrix, ["sid"], ["llvmpipe"], ["doctor"])


def test_a_root_without_a_server_of_virgl_fails_no_check(drivers, matrix, monkeypatch):
    """The root has it from the beginning: lists of packages expire in a root that stays."""
    assert "virgl-server" in drivers.PACKAGES
    without = dataclasses.replace(drivers.DRIVERS["virgl"], choose=f"PATH=/nowhere\n{drivers.VIRGL}")
    monkeypatch.setitem(drivers.DRIVERS, "virgl", without)
    monkeypatch.setitem(drivers.CHECKS, "doctor", drivers.Check("exit 4", 20))
    matrix.run("sid", "virgl", ["doctor"], again=False)
    assert matrix.outcome("sid", "virgl", "doctor")["status"] == drivers.NO_SETUP


def test_the_two_commands_of_a_newcomer_run_on_the_roots_own_default_alone(drivers, matrix):
    only = {driver: {"bench", "tests", "smoke", "contract"} & set(drivers.of(driver, list(drivers.CHECKS)))
            for driver in drivers.DRIVERS}
    assert only == {"llvmpipe": {"bench", "tests"}, "zink": {"smoke", "contract"}, "virgl": {"smoke", "contract"}}
    assert drivers.table(matrix, ["sid"], ["zink"], ["tests"]).splitlines()[-1] == "| sid | zink | – |"


def test_sources_without_gits_folder_are_those_that_git_lists(drivers, monkeypatch, tmp_path):
    """Downloaded as an archive, or copied into a root, where `make test` runs as well."""
    listed = ["Makefile", "a/b.py", "a/c d.txt", ".ci/run"]
    for name in [*listed, ".venv/bin/python", "a/__pycache__/b.pyc", ".drivers/sid.ready"]:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    monkeypatch.setattr(drivers, "SOURCES", tmp_path)
    assert sorted(drivers._sources()) == sorted(listed)
    (tmp_path / ".gitignore").write_text("".join(f"{name}/\n" for name in drivers.MADE))
    subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    assert sorted(drivers._sources()) == sorted([*listed, ".gitignore"])


@pytest.mark.parametrize(("options", "said"), [
    (["--root", "sidd"], "--root sidd: no such name; allowed: bookworm, "),
    (["--driver", "zinc"], "--driver zinc: no such name; allowed: llvmpipe, "),
    (["--check", "smok"], "--check smok: no such name; allowed: bench, "),
    (["--check", "bench,tests", "--driver", "zink,virgl"], "--check bench,tests: does not run with zink, virgl; "),
    (["--patience", "0"], "argument --patience: invalid factor value: '0'"),
    (["--patience", "nan"], "argument --patience: invalid factor value: 'nan'"),
    (["--dir", "/dev/null"], "--dir /dev/null: no folder; "),
    (["--dir", "/nowhere"], "--dir /nowhere: no such folder; "),
])
def test_a_wrong_option_is_told_from_a_check_that_fails(drivers, monkeypatch, capsys, options, said):
    monkeypatch.setattr(sys, "argv", ["drivers.py", "--table", *options])
    with pytest.raises(SystemExit) as ended:
        ending.run_script(drivers.main)
    assert ended.value.code == ending.MISUSED
    assert said in capsys.readouterr().err


PARENT = """
import subprocess, sys
child = subprocess.Popen(sys.argv[1:])
print(child.pid, flush=True)
child.wait()
"""


def test_what_runs_in_a_root_ends_with_the_script(drivers, matrix):
    bound = drivers.entering(matrix, "sid", "")
    command = [*bound[:bound.index("unshare")], "sleep", "60"]
    parent = subprocess.Popen([sys.executable, "-c", PARENT, *command], stdout=subprocess.PIPE, text=True)
    child = int(parent.stdout.readline())
    try:
        until(lambda: Path(f"/proc/{child}/comm").read_text().strip() == "sleep", "nothing runs in the root")
        parent.send_signal(signal.SIGKILL)
        parent.wait()
        until(lambda: not alive(child), "the child outlived its parent")
    finally:
        with suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)


def alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_the_workflow_has_a_job_for_each_root_and_driver(drivers):
    job = yaml.safe_load(WORKFLOW.read_text())["jobs"]["drivers"]
    assert job["strategy"]["matrix"] == {"root": list(drivers.ROOTS), "driver": list(drivers.DRIVERS),
                                         "exclude": [{"root": "bookworm", "driver": "virgl"}]}
    kept = next(step["with"] for step in job["steps"] if "upload-artifact" in step.get("uses", ""))
    assert kept["include-hidden-files"] is True  # the folder of logs begins with a dot
    assert json.dumps(job).count("${{ matrix.driver }}") >= 3


def test_a_job_of_the_workflow_outlasts_what_it_runs(drivers):
    """The logs are kept even where every check takes its longest."""
    wanted = [check for check in drivers.CHECKS if check != "features"]
    longest_s = max(sum(drivers.CHECKS[check].limit_s for check in drivers.of(driver, wanted))
                    for driver in drivers.DRIVERS)
    minutes = yaml.safe_load(WORKFLOW.read_text())["jobs"]["drivers"]["timeout-minutes"]
    assert minutes * 60 > drivers.ROOT_S + drivers.SETUP_S + longest_s
