"""The packages that are shipped: the wheel works without the repository, and the lock names every dependency."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tarfile
import zipfile
from importlib.metadata import requires
from pathlib import Path

import pytest

import mfr_bench

ROOT = Path(__file__).resolve().parent.parent
SHIPPED = {  # in the tree -> in _data
    "shaders": "shaders", "configs": "configs", "results/reference": "reference", "results/peers": "peers",
    "examples/my-array": "templates/my-array", "examples/spiral-scene": "templates/spiral-scene",
    "examples/median-layer": "templates/median-layer"}


def build(target: str, source: Path, out: Path) -> Path:
    """The one file that hatchling builds of `target` (wheel or sdist) from the tree at `source`."""
    command = [sys.executable, "-m", "hatchling", "build", "--target", target, "--directory", str(out)]
    done = subprocess.run(command, cwd=source, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (built,) = out.iterdir()
    return built


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    return build("wheel", ROOT, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def unpacked_sdist(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("unpacked")
    with tarfile.open(build("sdist", ROOT, tmp_path_factory.mktemp("sdist"))) as archive:
        archive.extraction_filter = getattr(tarfile, "data_filter", None)  # Python 3.10.0 to 3.10.11 have none
        archive.extractall(folder)  # noqa: S202 # an archive of this test's own making
    (top,) = folder.iterdir()
    return top


def names(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


def test_wheel_holds_the_package_and_its_data_and_nothing_else(wheel):
    """Shaders, configs and reference numbers are inside; tests, measured results and tools are not."""
    def below(folder):
        files = (f for f in (ROOT / folder).rglob("*") if f.is_file() and "__pycache__" not in f.parts)
        return (f.relative_to(ROOT / folder).as_posix() for f in files)

    package = {f"mfr_bench/{name}" for name in below("mfr_bench")}
    data = {f"mfr_bench/_data/{there}/{name}" for here, there in SHIPPED.items() for name in below(here)}
    metadata = {name for name in names(wheel) if name.startswith(f"mfr_bench-{mfr_bench.__version__}.dist-info/")}
    assert names(wheel) - metadata == package | data
    assert any(name.startswith("mfr_bench/_data/shaders/") for name in data)
    assert "mfr_bench/_data/configs/smoke.yaml" in data


def test_unpacked_wheel_works_without_the_repository(wheel, tmp_path):
    """`configs`, `run smoke --dry-run`, `new-method` and `check` of the wheel alone, in an empty folder."""
    site = tmp_path / "site"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)  # noqa: S202 # as above
    empty = tmp_path / "empty"
    empty.mkdir()

    def cli(*arguments: str) -> str:
        code = "import mfr_bench.cli; print(mfr_bench.cli.__file__); mfr_bench.cli.main()"
        done = subprocess.run([sys.executable, "-c", code, *arguments], cwd=empty, capture_output=True, text=True,
                              env=os.environ | {"PYTHONPATH": str(site)}, check=False)
        assert done.returncode == 0, done.stderr
        assert done.stdout.startswith(str(site))
        return done.stdout

    assert "smoke" in cli("configs")
    assert cli("run", "smoke", "--dry-run")
    cli("new-method", "mine")
    assert cli("check", "mine", "--methods", "mine", "--no-race").endswith("mine: every check passed\n")


def test_sdist_builds_the_same_wheel(wheel, unpacked_sdist, tmp_path):
    """Nothing that the wheel needs is missing from the source distribution."""
    assert names(build("wheel", unpacked_sdist, tmp_path)) == names(wheel)


def test_sdist_is_complete_without_what_machines_measured(unpacked_sdist):
    """Its two commands can be run; results/ holds the papers' numbers and the comparisons with others' code only."""
    for needed in ("Makefile", "requirements.lock", "requirements-run.lock", "requirements-uv.lock",
                   "scripts/setup.sh", "scripts/uv_install.py", "tests/test_packaging.py", "LICENSE"):
        assert (unpacked_sdist / needed).is_file(), needed
    assert sorted(f.name for f in (unpacked_sdist / "results").iterdir()) == ["peers", "reference"]


def pinned_in(lock: str) -> dict[str, str]:
    """The line of each pin, by the package. Every pin has a hash, and no line names an index or a path."""
    lines = (ROOT / lock).read_text().splitlines()
    entries = [line for line in lines if not line.lstrip().startswith("#")]
    pins = [i for i, line in enumerate(entries) if not line.startswith(" ")]
    assert all(re.match(r"[a-z0-9-]+==\S+( ; .+)? \\$", entries[i]) for i in pins)
    assert all(entries[i + 1].startswith("    --hash=sha256:") for i in pins)
    return {entries[i].partition("==")[0]: entries[i] for i in pins}


def test_lock_pins_every_dependency_with_hashes():
    """Each requirement of pyproject.toml is pinned."""
    pinned = pinned_in("requirements.lock").keys()
    declared = {re.match(r"[\w-]+", line)[0].lower() for line in requires("mfr-bench")}
    assert declared <= pinned, f"run `make lock`: {declared - pinned}"


def test_the_installer_is_pinned_with_hashes():
    """uv, and nothing else."""
    assert pinned_in("requirements-uv.lock").keys() == {"uv"}


def test_what_measuring_needs_has_the_same_pins():
    """What `make bench` installs is all that the package needs without extras, in the versions that are tested."""
    every, some = (pinned_in(lock) for lock in ("requirements.lock", "requirements-run.lock"))
    versions = {name: line.split()[0] for name, line in every.items()}
    assert {name: line.split()[0] for name, line in some.items()}.items() <= versions.items()
    assert len(some) < len(every) / 2
    without_extras = {re.match(r"[\w-]+", line)[0].lower() for line in requires("mfr-bench")
                      if "extra ==" not in line or 'extra == "build"' in line}
    assert without_extras <= some.keys(), f"run `make lock`: {without_extras - some.keys()}"
