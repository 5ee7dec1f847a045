"""How scripts end: in one line where a user, a file or a reader of the output ends them, never in a traceback."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SCRIPTS = ROOT / "scripts"
NO_SCRIPTS = {"ending.py", "in_turns.py",  # modules of the others
              "uv_install.py"}  # a part of setup.sh, which says what became of it


def ended(tmp_path, body: str, *, stdout=subprocess.PIPE) -> tuple[int, str]:
    """Exit status and stderr of a script whose main has this body."""
    path = tmp_path / "some.py"
    path.write_text("import subprocess, sys\nfrom ending import Misuse, at_least, run_script\n"
                    f"from mfr_bench.errors import UsageError\ndef main():\n    {body}\nrun_script(main)\n")
    done = subprocess.run([sys.executable, path], stdout=stdout, stderr=subprocess.PIPE, text=True, check=False,
                          env={"PYTHONPATH": f"{SCRIPTS}:{ROOT}"})
    return done.returncode, done.stderr


@pytest.mark.parametrize(("body", "status", "said"), [
    ("return 3", 3, ""),
    ("sys.exit(4)", 4, ""),
    ("sys.exit('no store')", 1, "some: no store\n"),
    ("open('/nowhere/x')", 1, "some: /nowhere/x: No such file or directory\n"),
    ("raise Misuse('--k 0: allowed: 1')", 2, "some: --k 0: allowed: 1\n"),
    ("raise UsageError('no method')", 2, "some: no method\n"),
    ("raise KeyboardInterrupt", 130, "some: interrupted\n"),
    ("subprocess.run(['false', '1'], check=True)", 1, "some: false 1: exit status 1\n"),
])
def test_a_script_ends_in_a_line_and_a_status(tmp_path, body, status, said):
    assert ended(tmp_path, body) == (status, said)


def test_a_fault_of_the_script_keeps_its_traceback(tmp_path):
    status, said = ended(tmp_path, "{}['gone']")
    assert status == 1 and said.startswith("Traceback") and "KeyError: 'gone'" in said


@pytest.mark.parametrize("body", ["print('a line')", "print('x' * 100_000)", "print('a line'); sys.exit(0)"])
def test_a_full_disk_is_told(tmp_path, body):
    with open("/dev/full", "w") as full:
        assert ended(tmp_path, body, stdout=full) == (1, "some: the output: No space left on device\n")


def test_a_reader_that_stops_ends_it_without_a_word(tmp_path):
    reader, writer = os.pipe()
    os.close(reader)
    assert ended(tmp_path, "print('x' * 100_000)", stdout=writer) == (141, "")


@pytest.mark.parametrize("path", sorted(set(SCRIPTS.glob("*.py")) - {SCRIPTS / name for name in NO_SCRIPTS}),
                         ids=lambda path: path.name)
def test_every_script_ends_so(path):
    assert path.read_text().endswith('if __name__ == "__main__":\n    run_script(main)\n')
