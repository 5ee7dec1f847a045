"""`make help` lists every target, and every target is one that no file of its name can hide."""

import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[1]
MAKEFILE = (ROOT / "Makefile").read_text()
TARGETS = set(re.findall(r"^([\w-]+):.*## ", MAKEFILE, flags=re.MULTILINE))


def test_help_lists_every_target():
    shown = subprocess.run(["make", "-s", "help"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert {line.split()[1] for line in shown.splitlines()} == TARGETS


def test_every_target_is_phony():
    assert set(re.search(r"^\.PHONY: (.*)$", MAKEFILE, flags=re.MULTILINE)[1].split()) == TARGETS


def test_tests_run_on_every_core_up_to_four():
    def workers(*given: str) -> str:
        done = subprocess.run(["make", "-s", "--eval=shown: ; @echo $(WORKERS)", "shown", *given], cwd=ROOT, text=True,
                              capture_output=True, check=True, env=os.environ | {"OMP_NUM_THREADS": "1"})
        return done.stdout.strip()

    assert workers() == str(min(4, len(os.sched_getaffinity(0))))
    assert workers("WORKERS=0") == "0"


def test_recipes_keep_bytecode():
    """Hundreds of processes read what one has compiled."""
    shown = subprocess.run(["make", "-s", "--eval=shown: ; @env", "shown"], cwd=ROOT, capture_output=True, text=True,
                           check=True, env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"}).stdout
    assert "PATH=" in shown
    assert "PYTHONDONTWRITEBYTECODE" not in shown
