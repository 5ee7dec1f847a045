"""What `make` installs: by uv with pip's settings, or by pip; all anew after an interruption; one setup at a time."""

import ensurepip
import hashlib
import importlib.util
import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
import time
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
UV = r"""#!/bin/sh
case $1 in
    --version) echo "uv 99.1.0"; exit ;;
    cache) echo "$LOG.cache"; exit ;;
esac
echo "begin $*" >>"$LOG"
env | grep -e '^UV_' -e '^SSL_' >>"$LOG"
sleep "${SLEEP:-0}"
[ -z "${FAILS:-}" ] || { printf 'error: no room\n  cause: a full disk\n' >&2; exit 2; }
echo end >>"$LOG"
"""
PROBE = "print('OpenGL 4.6 on a device of this test')\n"
SLOW_PROBE = """
import os, time
with open(os.environ["LOG"], "a") as log:
    print("begin", file=log, flush=True)
    time.sleep(0.5)
    print("end", file=log)
"""
BACKEND = '''
import pathlib, zipfile


def build_editable(folder, config_settings=None, metadata_directory=None):
    name = "mfr_bench-1-py3-none-any.whl"
    with zipfile.ZipFile(pathlib.Path(folder, name), "w") as wheel:
        wheel.writestr("mfr_bench-1.dist-info/METADATA", "Metadata-Version: 2.1\\nName: mfr-bench\\nVersion: 1\\n")
        wheel.writestr("mfr_bench-1.dist-info/WHEEL",
                       "Wheel-Version: 1.0\\nRoot-Is-Purelib: true\\nTag: py3-none-any\\n")
        wheel.writestr("mfr_bench-1.dist-info/RECORD", "")
    return name
'''
PYPROJECT = """
[build-system]
requires = []
build-backend = "backend"
backend-path = ["."]
[project]
name = "mfr-bench"
version = "1"
"""


def wheel(folder: Path, name: str, version: str, files: dict[str, str]) -> str:
    """Makes a wheel; its line of a lock."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}-{version}-py3-none-any.whl"
    info = f"{name}-{version}.dist-info"
    with zipfile.ZipFile(path, "w") as archive:
        for file, text in files.items():
            entry = zipfile.ZipInfo(file)
            entry.external_attr = 0o100755 << 16
            archive.writestr(entry, text)
        archive.writestr(f"{info}/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
        archive.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        archive.writestr(f"{info}/RECORD", "")
    return f"{name}=={version} --hash=sha256:{hashlib.sha256(path.read_bytes()).hexdigest()}\n"


def pip_of_python(folder: Path) -> str:
    """Copies the pip that this Python brings; its line of a lock."""
    places = [sysconfig.get_config_var("WHEEL_PKG_DIR"), Path(ensurepip.__file__).parent / "_bundled"]
    path = next(found for place in places if place for found in Path(place).glob("pip-*.whl"))
    shutil.copy(path, folder)
    version, digest = path.name.split("-")[1], hashlib.sha256(path.read_bytes()).hexdigest()
    return f"pip=={version} --hash=sha256:{digest}\n"


class Project:
    """A project of a few files that is set up as this one is, from a folder of wheels."""

    def __init__(self, folder: Path):
        self.folder, self.wheels, self.log = folder / "project", folder / "wheels", folder / "log"
        self.venv = self.folder / ".venv"
        for script in ("setup.sh", "uv_install.py"):
            target = self.folder / "scripts" / script
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / "scripts" / script, target)
        gpu = self.folder / "mfr_bench" / "gpu"
        gpu.mkdir(parents=True)
        (gpu / "probe.py").write_text(PROBE)
        (self.folder / "backend.py").write_text(BACKEND)
        (self.folder / "pyproject.toml").write_text(PYPROJECT)
        needed = wheel(self.wheels, "needed", "1", {"needed.py": ""})
        (self.folder / "requirements-run.lock").write_text(needed + pip_of_python(self.wheels))
        (self.folder / "requirements-uv.lock").write_text(
            wheel(self.wheels, "uv", "99.1.0", {"uv-99.1.0.data/scripts/uv": UV}))
        self.environment = {name: value for name, value in os.environ.items()
                            if not name.startswith(("PIP_", "UV_", "PYTHON"))}
        self.environment |= {"PIP_CONFIG_FILE": os.devnull, "PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(self.wheels),
                             "LOG": str(self.log)}

    def put_uv_on_path(self, text: str = UV) -> None:
        """A uv that is found before any other."""
        program = self.folder / "bin" / "uv"
        program.parent.mkdir()
        program.write_text(text)
        program.chmod(0o755)
        self.environment["PATH"] = f"{program.parent}:{self.environment['PATH']}"

    def start(self, step: str, **environment: str) -> subprocess.Popen:
        return subprocess.Popen(["scripts/setup.sh", step], cwd=self.folder, env=self.environment | environment,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)

    def set_up(self, step: str = "run", **environment: str) -> str:
        """What a step says that succeeds."""
        process = self.start(step, **environment)
        said = process.communicate(timeout=120)[0]
        assert process.returncode == 0, said
        return said

    def has(self, module: str) -> bool:
        return subprocess.run([self.venv / "bin" / "python", "-c", f"import {module}"], check=False,
                              capture_output=True).returncode == 0


@pytest.fixture
def project(tmp_path) -> Project:
    return Project(tmp_path)


def test_pinned_uv_is_fetched_and_installs_with_the_settings_of_pip(project):
    """Nothing is left of what installing needed; the driver that was found meanwhile is not looked for again."""
    project.environment["PATH"] = os.defpath
    said = project.set_up(PIP_TIMEOUT="7")
    assert "pip installs" not in said
    log = project.log.read_text()
    assert "--require-hashes --only-binary :all: -r requirements-run.lock" in log
    assert "--editable ." in log
    assert log.count(" --no-index ") == 2
    assert {f"UV_FIND_LINKS={project.wheels}", "UV_HTTP_TIMEOUT=7"} <= set(log.splitlines())
    assert not {"bundled-pip", "pip-settings", "unfinished"} & set(os.listdir(project.venv))
    (project.folder / "mfr_bench" / "gpu" / "probe.py").write_text("raise SystemExit(3)")
    assert project.set_up("driver") == "setup: OpenGL 4.6 on a device of this test\n"


def test_pip_installs_where_uv_fails(project):
    """One line says so. pip is in .venv afterwards, as uv would have put it there."""
    project.put_uv_on_path()
    said = project.set_up(FAILS="1")
    assert [line for line in said.splitlines() if "pip" in line] == [
        "setup: uv failed, so pip installs, which takes longer: error: no room cause: a full disk"]
    assert project.has("needed")
    assert (project.venv / "bin" / "pip").exists()


def test_reasons_are_told_where_no_file_can_be_written(project):
    """What uv and pip say goes into no file, which a full disk would leave empty."""
    project.put_uv_on_path()
    project.set_up(FAILS="1")
    for log in ("uv.log", "pip.log"):
        (project.venv / log).unlink(missing_ok=True)
        (project.venv / log).mkdir()
    assert "takes longer: error: no room cause: a full disk\n" in project.set_up(FAILS="1")


def test_pip_stops_at_a_wrong_hash_where_there_is_no_uv(project):
    """A uv older than the pinned one counts as none."""
    project.put_uv_on_path(UV.replace("99.1.0", "99.0.9"))
    next(project.wheels.glob("uv-*")).unlink()
    lock = project.folder / "requirements-run.lock"
    lock.write_text(re.sub("sha256:....", "sha256:0000", lock.read_text()))
    process = project.start("run")
    said = process.communicate(timeout=120)[0]
    assert process.returncode == 1
    assert "setup: there is no uv for this machine or from this index: pip installs, which takes longer\n" in said
    assert said.endswith("setup: pip could not install requirements-run.lock (above)\n")
    assert not project.has("needed")


def test_interrupted_setup_begins_anew(project):
    """Files of the interrupted one are gone; those of a setup that ended are kept."""
    project.put_uv_on_path()
    process = project.start("run", SLEEP="60")
    while not (project.log.exists() and "begin" in project.log.read_text()):
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    half = project.venv / "half"
    half.touch()
    assert "making .venv" in project.set_up()
    assert not half.exists()
    half.touch()
    (site,) = project.venv.glob("lib/python*/site-packages")
    (site / "pip.py").touch()  # what the uv of this test does not install
    assert "making .venv" not in project.set_up()
    assert half.exists()


def test_second_setup_waits_for_the_first(project):
    """Two setups at once run one after the other."""
    (project.venv / "bin").mkdir(parents=True)
    (project.venv / "bin" / "python").symlink_to(sys.executable)
    (project.folder / "mfr_bench" / "gpu" / "probe.py").write_text(SLOW_PROBE)
    running = [project.start("driver") for _ in range(2)]
    said = [process.communicate(timeout=120)[0] for process in running]
    assert [process.returncode for process in running] == [0, 0]
    assert sum(f"waiting for another setup in {project.folder}" in text for text in said) == 1
    assert project.log.read_text().split() == ["begin", "end"] * 2


@pytest.fixture
def uv_install():
    """The script as a module."""
    spec = importlib.util.spec_from_file_location("uv_install", ROOT / "scripts" / "uv_install.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_settings_of_pip_override_each_other_as_in_pip(uv_install):
    """Variables before [install] before [global]; other commands' are not meant."""
    listed = (":env:.timeout='1'\ndownload.timeout='4'\nglobal.index-url='a'\nglobal.timeout='3'\n"
              "install.index_url='b'\ninstall.find-links='c\\nd'")
    assert uv_install.settings(listed) == {"index-url": "b", "timeout": "1", "find-links": "c\nd"}


def test_file_that_contradicts_another_is_left_to_pip(uv_install):
    assert uv_install.settings("global.timeout='3'\nglobal.timeout='3'") == {"timeout": "3"}
    with pytest.raises(uv_install.UntoldError, match=r"^global\.timeout: several files of pip's set it$"):
        uv_install.settings("global.timeout='3'\nglobal.timeout='4'")


@pytest.mark.parametrize(("option", "value", "variable"), [
    ("index-url", "https://a/simple", "UV_DEFAULT_INDEX=https://a/simple"),
    ("extra-index-url", "\nhttps://a\nhttps://b", "UV_INDEX=https://a https://b"),
    ("find-links", "/does/not/exist https://a /", "UV_FIND_LINKS=https://a,/"),
    ("trusted-host", "a b:8", "UV_INSECURE_HOST=a b:8"),
    ("no-cache-dir", "true", "UV_NO_CACHE=1"), ("default-timeout", "15.0", "UV_HTTP_TIMEOUT=15"),
    ("retries", "2", "UV_HTTP_RETRIES=2"), ("client-cert", __file__, f"SSL_CLIENT_CERT={__file__}"),
    ("proxy", "me:secret@a:3128", "HTTPS_PROXY=http://me:secret@a:3128"),
    ("cert", __file__, f"SSL_CERT_FILE={__file__}"), ("cert", "/", "SSL_CERT_DIR=/")])
def test_setting_of_pip_is_told_uv(uv_install, option, value, variable):
    told = uv_install.variables({option: value, "quiet": "1"}, set(), {})
    assert variable in [f"{name}={text}" for name, text in told.items()]


def real_uv() -> str:
    """The uv that `make` fetched or found."""
    own = Path(sys.executable).parent / "uv"
    found = str(own) if own.exists() else shutil.which("uv")
    if not found:
        pytest.skip("there is no uv for this machine: pip installed")
    return found


def index(folder: Path) -> tuple[str, str]:
    """A package index of one package; its address, and the package's line of a lock."""
    line = wheel(folder / "needed", "needed", "1", {"needed.py": ""})
    name = next((folder / "needed").glob("*.whl")).name
    (folder / "needed" / "index.html").write_text(f'<a href="{name}">{name}</a>')
    return folder.as_uri(), line


@pytest.mark.parametrize(("listed", "status"), [
    ("global.index-url='{index}'", 0), ("global.index-url='{empty}'\nglobal.extra-index-url='{index}'", 0),
    ("global.index-url='{empty}'\nglobal.find-links='{index}/needed'", 0),
    ("global.index-url='{empty}'", 1), (":env:.no-index='1'\nglobal.index-url='{index}'", 1)])
def test_real_uv_takes_packages_from_where_pip_would(tmp_path, listed, status):
    """And from nowhere else, whatever its own variables say."""
    address, line = index(tmp_path / "index")
    (tmp_path / "empty").mkdir()
    (tmp_path / "lock").write_text(line)
    (tmp_path / "settings").write_text(listed.format(index=address, empty=(tmp_path / "empty").as_uri()))
    done = subprocess.run([sys.executable, ROOT / "scripts" / "uv_install.py", real_uv(), tmp_path / "settings",
                           "--target", tmp_path / "site", "--no-deps", "--require-hashes", "-r", tmp_path / "lock"],
                          env=os.environ | {"UV_CACHE_DIR": str(tmp_path / "cache"), "UV_EXTRA_INDEX_URL": address},
                          capture_output=True, text=True, check=False)
    assert done.returncode == status, done.stderr
    assert (tmp_path / "site" / "needed.py").exists() == (status == 0)


def test_certificates_of_requests_count_as_in_pip(uv_install):
    """Certificates of the environment count where pip is told none; without any, the system's where it has some."""
    assert uv_install.certificates({}, {"REQUESTS_CA_BUNDLE": __file__}) == {"SSL_CERT_FILE": __file__}
    assert uv_install.certificates({"cert": __file__}, {"CURL_CA_BUNDLE": "/"}) == {"SSL_CERT_FILE": __file__}
    assert uv_install.certificates({}, {}) in ({}, {"UV_SYSTEM_CERTS": "1"})


def test_certificates_of_pip_are_the_only_ones(uv_install):
    """uv trusts those of both variables; its own variables, but for those of its cache, are not handed on."""
    inherited = {"SSL_CERT_DIR": "/etc/ssl/certs", "UV_INDEX": "https://a", "UV_CACHE_DIR": "/c", "HOME": "/h"}
    kept = {"UV_CACHE_DIR": "/c", "HOME": "/h"}
    assert uv_install.environment_of_uv(inherited, {"SSL_CERT_FILE": "/b"}) == kept | {"SSL_CERT_FILE": "/b"}
    assert uv_install.environment_of_uv(inherited, {}) == kept | {"SSL_CERT_DIR": "/etc/ssl/certs"}


def test_certificates_that_are_not_there_are_left_to_pip(uv_install):
    """uv would take its own instead."""
    for option in ("cert", "client-cert"):
        with pytest.raises(uv_install.UntoldError, match=r"^/c\.pem: there is no such file of certificates$"):
            uv_install.certificates({option: "/c.pem"}, {})


@pytest.mark.parametrize("option", ["no-binary", "keyring-provider", "target"])
def test_setting_that_uv_lacks_is_named(uv_install, option):
    with pytest.raises(uv_install.UntoldError, match=f"^{option}: uv has none like it$"):
        uv_install.variables({option: "x"}, set(), {})


def test_constraints_matter_where_they_name_what_is_pinned(uv_install, tmp_path):
    file = tmp_path / "constraints.txt"
    file.write_text("# caps\nTorch_Vision<2\n\nother==1\n")
    assert uv_install.told("constraint", str(file), {"numpy"}) == {}
    for value, pinned in ((str(file), {"torch-vision"}), ("/does/not/exist", set())):
        with pytest.raises(uv_install.UntoldError, match=r"^constraint .*: (it may concern|cannot be read)"):
            uv_install.told("constraint", value, pinned)
    file.write_text("-c others.txt\n")
    with pytest.raises(uv_install.UntoldError):
        uv_install.told("constraint", str(file), {"numpy"})


def test_place_that_cannot_be_written_keeps_no_cache(uv_install, tmp_path):
    program = tmp_path / "uv"
    for place, told in ((tmp_path / "cache", {}), (program / "cache", {"UV_NO_CACHE": "1"})):
        program.write_text(f"#!/bin/sh\necho {place}\n")
        program.chmod(0o755)
        assert uv_install.without_cache(str(program)) == told
