#!/usr/bin/env python3
"""Tests mfr-bench on the OpenGL drivers that a CPU can run, each in a fresh root made by debootstrap; needs root.

    sudo scripts/drivers.py                              every root and driver
    sudo scripts/drivers.py --root trixie --driver zink  one of them, or several with commas between
    scripts/drivers.py --table                           the table of what was run before

Goes on where it stopped: a check that ended is not run again until a file of the work tree changes (--again). Roots,
logs and outcomes are in --dir. The network is needed for Debian's or Ubuntu's packages and PyPI alone.
docs/drivers.md says what is known of each driver.

Exit status: 0 every check passed; 1 some failed; 2 an option is wrong; 3 none failed, but some were not run.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ending import FAILED, Misuse, run_script

SOURCES = Path(__file__).resolve().parent.parent
DEBIAN, UBUNTU = "http://deb.debian.org/debian", "http://archive.ubuntu.com/ubuntu"
ROOTS = {"bookworm": DEBIAN, "trixie": DEBIAN, "forky": DEBIAN, "sid": DEBIAN, "noble": UBUNTU, "resolute": UBUNTU}
PACKAGES = ("ca-certificates", "python3", "python3-venv", "python3-dev", "g++", "make", "git", "libegl1", "libgl1",
            "libgl1-mesa-dri", "mesa-vulkan-drivers", "glslang-tools", "virgl-server")
KEYRING = "usr/share/keyrings/ubuntu-archive-keyring.gpg"
KEYS_FROM = "trixie"  # a root whose distribution has a package of Ubuntu's keys, as Debian 12 has not
NOT_RUN = 3  # exit status: no check failed, but some did not run
ROOT_S = 600  # the longest that making a root may take
SETUP_S = 900  # the longest that a setup may take: Python 3.14 compiles flip-evaluator
NO_SETUP = 75  # status of a check whose root could not be entered or set up
MADE = {".venv", ".drivers", ".hypothesis", ".pytest_cache", ".ruff_cache", "__pycache__", "dist"}  # no sources
SCRIPTS = Path("/usr/share/debootstrap/scripts")
INSIDE = """
{ mount --make-rprivate / && mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" &&
  mount -t sysfs sysfs "$0/sys"; } || exit 75
exec chroot "$0" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive bash -c "$1"
"""
VIRGL = """
command -v virgl_test_server >/dev/null || { echo "no virgl_test_server: delete the root to make it anew"; exit 75; }
virgl_test_server --use-egl-surfaceless >/tmp/virgl.log 2>&1 & server=$!; trap 'kill $server' EXIT; sleep 1
export GALLIUM_DRIVER=virpipe LIBGL_ALWAYS_SOFTWARE=1
"""
MEASURE = ".venv/bin/mfr-bench {} --out /tmp/drivers/$NAME --device {}"


@dataclass(frozen=True)
class Driver:
    """The variables that choose a driver inside a root, and the beginning of its renderer's name."""

    choose: str
    renderer: str


DRIVERS = {
    "llvmpipe": Driver("", "llvmpipe"),
    # The folder: a layer of Mesa 24's Vulkan looks for Wayland, and complains on stderr where a session has none.
    "zink": Driver("export MESA_LOADER_DRIVER_OVERRIDE=zink LIBGL_ALWAYS_SOFTWARE=1 XDG_RUNTIME_DIR=/tmp", "zink"),
    "virgl": Driver(VIRGL, "virgl"),
}


@dataclass(frozen=True)
class Check:
    """One command in a root, with the longest that it may take, and the drivers with which it runs."""

    command: str
    limit_s: int
    drivers: Sequence[str] = tuple(DRIVERS)


BENCH = "bench"  # the check that sets itself up

CHECKS = {
    BENCH: Check("rm -rf .venv; make bench", 1200, ["llvmpipe"]),  # a newcomer's two commands, on the root's default
    "tests": Check("make test", 1800, ["llvmpipe"]),
    "doctor": Check(".venv/bin/mfr-bench doctor --device $DEVICE", 120),
    "smoke": Check(f"{MEASURE.format('run smoke --force', '$DEVICE')}", 300, ["zink", "virgl"]),  # of llvmpipe, bench
    "conformance": Check(MEASURE.format("run conformance determinism device-features --profile smoke", "$DEVICE"),
                         1200),
    "stress": Check(f"{MEASURE.format('stress --profile smoke', '$DEVICE')}\n"
                    ".venv/bin/python scripts/stress_breaks.py /tmp/drivers/$NAME", 1200),
    "features": Check(".venv/bin/python -m pytest -q tests/gpu/test_trials.py tests/contract/test_images.py "
                      "-k 'trial or fault or native or interlock or 128'", 600),
    "contract": Check(".venv/bin/python -m pytest -q -n 2 --dist worksteal tests/contract tests/gpu", 1200,
                      ["zink", "virgl"]),  # of llvmpipe, `make test` has run it
}


class Matrix:
    """The roots, logs and outcomes below one folder."""

    def __init__(self, folder: Path, patience: float = 1.0):
        self.folder = folder
        self.patience = patience
        self.sources = _sources()
        self.stamp = _stamp(self.sources)
        self._ready: dict[str, bool] = {}  # whether a root is set up, once that was tried

    def run(self, root: str, driver: str, checks: Sequence[str], again: bool) -> None:
        """Run the checks of one driver in one root, and keep how each ended."""
        wanted = [c for c in of(driver, checks) if again or self.outcome(root, driver, c).get("stamp") != self.stamp]
        if not wanted or not self._made(root):
            return
        self._copy_sources(root)
        for check in wanted:
            if check != BENCH and not self._set_up(root):
                self._keep(root, driver, check, {"status": NO_SETUP, "seconds": 0})
            else:
                self._keep(root, driver, check, self._check(root, driver, check))

    def _set_up(self, root: str) -> bool:
        """Whether the sources that were copied last are set up."""
        if root not in self._ready:
            begun = time.monotonic()
            status = self._logged(root, "none", "setup", self._inside(root, "cd /mfr-bench && make setup"), SETUP_S)
            self._keep(root, "none", "setup", {"status": status, "seconds": round(time.monotonic() - begun)})
            self._ready[root] = status == 0
        return self._ready[root]

    def outcome(self, root: str, driver: str, check: str) -> Mapping[str, object]:
        """The end of a check, or nothing."""
        try:
            return json.loads(self._log(root, driver, check).with_suffix(".json").read_text())
        except (OSError, ValueError):
            return {}

    def _log(self, root: str, driver: str, check: str) -> Path:
        return self.folder / "logs" / f"{root}-{driver}-{check}.log"

    def _keep(self, root: str, driver: str, check: str, outcome: Mapping[str, object]) -> None:
        path = self._log(root, driver, check).with_suffix(".json")
        path.write_text(json.dumps({"stamp": self.stamp, **outcome}))
        say(f"{root}, {driver}, {check}: {said(outcome)}")

    def _made(self, root: str) -> bool:
        """Whether the root is there; makes it where it is not. A root that was not finished is made anew."""
        place, ready = self.folder / root, self.folder / f"{root}.ready"
        if ready.exists():
            return True
        shutil.rmtree(place, ignore_errors=True)
        script = [] if (SCRIPTS / root).exists() else [str(SCRIPTS / ("sid" if ROOTS[root] == DEBIAN else "gutsy"))]
        begun = time.monotonic()
        of_ubuntu = [f"--keyring={self._keyring()}", "--components=main,universe"] if ROOTS[root] == UBUNTU else []
        made = self._logged(root, "none", "root", ["debootstrap", "--variant=minbase", "--force-check-gpg", *of_ubuntu,
                                                   f"--include={','.join(PACKAGES)}", root, str(place), ROOTS[root],
                                                   *script], ROOT_S)
        self._keep(root, "none", "root", {"status": made, "seconds": round(time.monotonic() - begun)})
        if made != 0:
            return False
        for file in ("/etc/resolv.conf", "/etc/ssl/certs/ca-certificates.crt"):  # a proxy may have its own certificate
            shutil.copy(file, f"{place}{file}")
        ready.touch()
        return True

    def _keyring(self) -> Path:
        """Ubuntu's keys: this machine's, or those of a root of Debian."""
        own, inside = Path("/", KEYRING), self.folder / KEYS_FROM / KEYRING
        if own.exists():
            return own
        if self._made(KEYS_FROM) and not inside.exists():
            install = "apt-get -qq update && apt-get -qq install -y ubuntu-archive-keyring"
            self._logged(KEYS_FROM, "none", "keyring", self._inside(KEYS_FROM, install), 120)
        return inside

    def _inside(self, root: str, script: str) -> list[str]:
        """The command that runs a script of bash in a root; what it started ends with it, and it with this process."""
        return ["setpriv", "--pdeathsig", "KILL", "unshare", "--mount", "--pid", "--fork", "--kill-child",
                "bash", "-c", INSIDE, str(self.folder / root), script]

    def _copy_sources(self, root: str) -> None:
        """The work tree as it is now, beside the .venv of earlier runs."""
        place = self.folder / root / "mfr-bench"
        for path in place.glob("*") if place.exists() else ():
            if path.name != ".venv":
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        for source in self.sources:
            target = place / source
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(SOURCES / source, target, follow_symlinks=False)

    def _check(self, root: str, driver: str, check: str) -> Mapping[str, object]:
        begun = time.monotonic()
        lines = ["set -e; cd /mfr-bench",
                 f"NAME={driver}-{check}; DEVICE={DRIVERS[driver].renderer}; mkdir -p /tmp/drivers",
                 DRIVERS[driver].choose, CHECKS[check].command]
        status = self._logged(root, driver, check, self._inside(root, "\n".join(lines)), CHECKS[check].limit_s)
        return {"status": status, "seconds": round(time.monotonic() - begun), "last": self._last(root, driver, check)}

    def _logged(self, root: str, driver: str, check: str, command: Sequence[str], limit_s: int) -> int:
        """The exit status; 124 where the time limit was reached, 127 where the command is not installed."""
        path = self._log(root, driver, check)
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("w") as log:
            try:
                return subprocess.run(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, check=False,
                                      timeout=limit_s * self.patience).returncode
            except subprocess.TimeoutExpired:
                return 124
            except FileNotFoundError as error:
                log.write(f"{error}\n")
                return 127

    def _last(self, root: str, driver: str, check: str) -> str:
        lines = self._log(root, driver, check).read_text(errors="replace").splitlines()
        summary = [line for line in lines if " passed" in line or " cells: " in line or line.startswith("version")]
        return " ".join((summary or lines or [""])[-1].split())[:120]


def of(driver: str, checks: Sequence[str]) -> list[str]:
    """The checks that run with the driver."""
    return [check for check in checks if driver in CHECKS[check].drivers]


def _sources() -> list[str]:
    """Every file that git tracks or would, results of earlier runs left out.

    In a tree without git's folder: every file outside the folders that setting up and tests make.
    """
    if (SOURCES / ".git").exists():
        listed = subprocess.run(["git", "-C", str(SOURCES), "ls-files", "-co", "--exclude-standard", "-z"],
                                capture_output=True, text=True, check=True).stdout.split("\0")
        return [name for name in listed if name and (SOURCES / name).is_file()]
    found = (path.relative_to(SOURCES) for path in SOURCES.rglob("*") if path.is_file())
    return [str(path) for path in found if not MADE.intersection(path.parts)]


def _stamp(sources: Sequence[str]) -> str:
    """A hash of what a check depends on: every file but documents and results."""
    digest = hashlib.sha256()
    for name in sorted(sources):
        if not name.startswith(("docs/", "results/", "findings/")):
            digest.update(name.encode() + b"\0" + (SOURCES / name).read_bytes())
    return digest.hexdigest()[:16]


def said(outcome: Mapping[str, object]) -> str:
    """A cell of the table."""
    if not outcome:
        return "not run"
    ended = {0: "pass", 124: "timeout", NO_SETUP: "not set up"}.get(outcome["status"], f"FAIL ({outcome['status']})")
    return f"{ended}, {outcome['seconds']} s"


def table(matrix: Matrix, roots: Sequence[str], drivers: Sequence[str], checks: Sequence[str]) -> str:
    """Markdown: a row for each root and driver, a column for each check."""
    rows = [("root", "driver", *checks), ("---",) * (2 + len(checks))]
    rows += [(root, driver, *(said(matrix.outcome(root, driver, check)) if check in of(driver, checks) else "–"
                              for check in checks)) for root in roots for driver in drivers]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def say(text: str) -> None:
    print(f"drivers: {text}", file=sys.stderr, flush=True)


def factor(text: str) -> float:
    """A number above 0, by which times are multiplied. Raises ValueError."""
    if not 0 < float(text) < float("inf"):
        raise ValueError(text)
    return float(text)


def chosen(text: str | None, known: Mapping[str, object], option: str) -> list[str]:
    """The names that an option lists, or all."""
    names = list(known) if text is None else text.split(",")
    for name in names:
        if name not in known:
            raise Misuse(f"{option} {name}: no such name; allowed: {', '.join(known)}")
    return names


def missing() -> str | None:
    """The thing that this machine lacks to make roots and enter them, or None."""
    if not shutil.which("debootstrap"):
        return "debootstrap is missing; run: sudo apt-get install -y debootstrap debian-archive-keyring"
    if subprocess.run(["unshare", "--mount", "true"], capture_output=True, check=False).returncode:
        return "mounting in a root of its own is not allowed; run it as root: sudo make drivers"
    return None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", help=f"of {', '.join(ROOTS)}; all by default")
    parser.add_argument("--driver", help=f"of {', '.join(DRIVERS)}; all by default")
    parser.add_argument("--check", help=f"of {', '.join(CHECKS)}; all but features, a part of "
                        "contract, by default")
    parser.add_argument("--dir", type=Path, default=SOURCES / ".drivers", help="default: %(default)s")
    parser.add_argument("--patience", type=factor, default=1.0, metavar="FACTOR", help="multiplies every check's time "
                        "limit, for a machine that has other work (default: %(default)s)")
    parser.add_argument("--again", action="store_true", help="run checks that ended before, too")
    parser.add_argument("--table", action="store_true", help="print the table and run nothing")
    given = parser.parse_args()
    roots, drivers = chosen(given.root, ROOTS, "--root"), chosen(given.driver, DRIVERS, "--driver")
    checks = chosen(given.check or ",".join(c for c in CHECKS if c != "features"), CHECKS, "--check")
    if not any(of(driver, checks) for driver in drivers):
        raise Misuse(f"--check {given.check}: does not run with {', '.join(drivers)}; docs/drivers.md says what runs "
                     "where")
    if given.dir.exists() and not given.dir.is_dir():
        raise Misuse(f"--dir {given.dir}: no folder; allowed: a folder, or a path where one can be made")
    if given.table and not given.dir.exists() and given.dir != parser.get_default("dir"):
        raise Misuse(f"--dir {given.dir}: no such folder; allowed: the --dir of a run before")
    matrix = Matrix(given.dir.resolve(), given.patience)
    if not given.table:
        if lacking := missing():
            say(lacking)
            return NOT_RUN
        for root in roots:
            for driver in drivers:
                matrix.run(root, driver, checks, given.again)
    print(table(matrix, roots, drivers, checks))
    found = [matrix.outcome(root, driver, check).get("status") for root in roots for driver in drivers
             for check in of(driver, checks)]
    not_run = None in found or NO_SETUP in found
    return FAILED if set(found) - {None, 0, NO_SETUP} else NOT_RUN if not_run else 0


if __name__ == "__main__":
    run_script(main)
