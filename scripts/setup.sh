#!/bin/sh
# Sets up what the Makefile's targets need, or stops with the line that does.
#
#   scripts/setup.sh run      .venv with this package, editable, and what it needs to measure (requirements-run.lock)
#   scripts/setup.sh python   the other locked dependencies as well, of tests and extras (requirements.lock)
#   scripts/setup.sh driver   an OpenGL >= 4.3 driver: Mesa's software driver where there is none
#
# PYTHON=/path/to/python3 chooses the interpreter of a new .venv. uv installs: one on the PATH, or the pinned one, which
# pip fetches. Where uv cannot be had or fails, pip installs the same, which takes some seconds more.
set -eu
cd "$(dirname "$0")/.."
venv=.venv
bundled=$PWD/$venv/bundled-pip  # the pip that comes with Python, unpacked until the pinned one is installed
settings=$venv/pip-settings  # what `pip config list` says while something is installed: addresses may hold passwords
unfinished=$venv/unfinished  # is there while something is installed: what was interrupted may lack files

say() {
    echo "setup: $*" >&2
}

stop() {
    say "$*"
    exit 1
}

# apt_install REASON PACKAGE...: installs as root or by sudo without a password, else stops with the line to run.
apt_install() {
    reason=$1
    shift
    sudo="sudo "
    [ "$(id -u)" != 0 ] || sudo=""
    line="${sudo}apt-get update && ${sudo}apt-get install -y $*"
    command -v apt-get >/dev/null || stop "$reason; install what Debian calls $*"
    [ -z "$sudo" ] || sudo -n true 2>/dev/null || stop "$reason; run: $line"
    say "$reason; running: $line"
    apt="${sudo:+sudo -n }env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300"
    for _ in 1 2; do
        # An update that fails for one foreign archive may still have what is needed.
        # shellcheck disable=SC2086 # $apt is several words
        $apt update >&2 9<&- || true
        # shellcheck disable=SC2086
        $apt install -y --no-install-recommends "$@" >&2 9<&- && return
    done
    stop "$reason, and apt-get failed (above); once it works again, run: $line"
}

candidates() {
    if [ -n "${PYTHON:-}" ]; then
        echo "$PYTHON"
    else
        printf '%s\n' python3 python3.13 python3.12 python3.11 python3.10 python3.14 python3.15
    fi
}

# find_python MODULES: the first Python >= 3.10 that runs and can import them, or nothing.
find_python() {
    candidates | while IFS= read -r candidate; do
        if "$candidate" -c "import sys, $1; sys.exit(sys.version_info < (3, 10))" >/dev/null 2>&1; then
            echo "$candidate"
            break
        fi
    done
}

# version_name PYTHON: as Debian names its packages, e.g. python3.12.
version_name() {
    "$1" -c 'import sys; print("python%d.%d" % sys.version_info[:2])'
}

make_venv() {
    python=$(find_python "ensurepip, venv")
    if [ -z "$python" ]; then
        python=$(find_python "os")
        if [ -z "$python" ] && [ -z "${PYTHON:-}" ]; then
            apt_install "there is no Python >= 3.10" python3 python3-venv
            python=$(find_python "ensurepip, venv")
        fi
        [ -n "$python" ] || stop "none is Python >= 3.10: $(candidates | paste -sd ' ' -); set PYTHON=/path/to/python3"
        apt_install "$python cannot make virtual environments" "$(version_name "$python")-venv"
        "$python" -c "import ensurepip, venv" || stop "$python still cannot; set PYTHON=/path/to/another/python3"
    fi
    say "making $venv with $("$python" --version)"
    rm -rf "$venv"
    "$python" -m venv --without-pip "$venv" ||
        stop "$python -m venv $venv failed (above); set PYTHON=/path/to/another/python3"
    touch "$unfinished"
    unpack_pip || "$venv/bin/python" -m ensurepip --default-pip >/dev/null ||
        stop "$python -m ensurepip failed (above); set PYTHON=/path/to/another/python3"
}

# Installing it, as ensurepip does, takes 4 s; it can do its work from where it is unpacked, too.
unpack_pip() {
    "$venv/bin/python" - "$bundled" 2>/dev/null <<'END'
import ensurepip, pathlib, sys, sysconfig, zipfile

folders = [sysconfig.get_config_var("WHEEL_PKG_DIR"), pathlib.Path(ensurepip.__file__).parent / "_bundled"]
wheels = [sorted(pathlib.Path(folder).glob("pip-*.whl")) for folder in folders if folder]
zipfile.ZipFile(next(found[-1] for found in wheels if found)).extractall(sys.argv[1])
END
}

# The pip of .venv, or where it has none yet the unpacked one.
pip() {
    PYTHONPATH=$bundled "$venv/bin/python" -m pip "$@"
}

# Python compiles a module when it is first imported: most of what is installed never is.
pip_install() {
    # The unpacked pip would else count as installed.
    [ ! -d "$bundled" ] || set -- --ignore-installed "$@"
    pip install --quiet --no-input --disable-pip-version-check --no-deps --no-compile "$@"
}

# find_uv: sets uv to a program that is at least as new as the pinned minor version, or to nothing.
find_uv() {
    rm -f "$settings"
    trap 'rm -f "$settings"' EXIT
    # Without these dash ends by a signal without the line above.
    trap 'exit 130' INT
    trap 'exit 143' HUP TERM
    (umask 077 && pip config list >"$settings" 2>/dev/null) &
    listing=$!
    for uv in "$venv/bin/uv" "$(command -v uv || true)" fetch; do
        if [ "$uv" = fetch ]; then
            uv=$venv/bin/uv
            # One retry: without a network pip has yet to say so of what is needed.
            pip_install --retries 1 --require-hashes --only-binary :all: -r requirements-uv.lock 2>"$venv/uv.log" || true
        fi
        ! recent "$uv" || break
        uv=
    done
    wait "$listing" || uv=
    [ -n "$uv" ] || say "there is no uv for this machine or from this index: pip installs, which takes longer"
}

# recent PROGRAM: whether it is a uv that runs and is new enough.
recent() {
    wanted=$(sed -n 's/^uv==\([0-9]*\.[0-9]*\).*/\1/p' requirements-uv.lock)
    has=$("$1" --version 2>/dev/null) || return 1
    has=${has#uv }
    printf '%s\n' "$wanted" "${has%% *}" | sort -VC
}

# by_uv ARGUMENT...: fails where uv does, and from then on pip is taken.
by_uv() {
    [ -n "$uv" ] || return 1
    why=$("$venv/bin/python" scripts/uv_install.py "$uv" "$settings" --no-deps "$@" 2>&1) && return
    say "uv failed, so pip installs, which takes longer: $(echo "$why" | paste -sd ' ' - | tr -s ' ')"
    uv=
    return 1
}

can_compile() {
    command -v c++ >/dev/null && "$venv/bin/python" -c '
import os, sys, sysconfig
sys.exit(not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")))'
}

# compile_dependencies LOCK: also those that have no wheel; what their builds need comes from the lock, too.
compile_dependencies() {
    can_compile || apt_install "this Python or processor lacks some wheels, and compiling them needs a compiler" \
        g++ "$(version_name "$venv/bin/python")-dev"
    say "compiling the dependencies that have no wheel here (minutes)"
    sed -n 's/ *\\$//; /^[a-z]/p' requirements.lock >"$venv/constraints.txt"
    PIP_CONSTRAINT=$venv/constraints.txt PIP_BUILD_CONSTRAINT=$venv/constraints.txt \
        pip_install --require-hashes -r "$1" || stop "a dependency did not compile (above)"
}

# install_dependencies LOCK: what a file of pinned requirements names.
install_dependencies() {
    say "installing $1 into $venv"
    if by_uv --require-hashes --only-binary :all: -r "$1"; then
        return
    fi
    # Not into a file: a full disk would keep the reason to itself.
    why=$(pip_install --require-hashes --only-binary :all: -r "$1" 2>&1) && return
    case $why in
        *Retrying* | *"No space left"*) ;;
        *"No matching distribution"*)
            compile_dependencies "$1"
            return
            ;;
    esac
    echo "$why" >&2
    stop "pip could not install $1 (above)"
}

install_package() {
    by_uv --no-build-isolation --reinstall-package mfr-bench --editable . ||
        pip_install --no-build-isolation --editable . || stop "the package itself did not install (above)"
}

# What a run imports is compiled now, by the processor that nothing else uses, rather than while it measures.
compile_imports() {
    "$venv/bin/python" -c "
import click, jinja2, pydantic, rich, yaml
import matplotlib.backends.backend_agg, matplotlib.backends.backend_svg, matplotlib.figure" >/dev/null 2>&1
}

usable() {
    [ ! -e "$unfinished" ] && "$venv/bin/python" -c "
import pip, sys
sys.exit(sys.version_info < (3, 10) or sys.prefix == sys.base_prefix)" 2>/dev/null
}

setup_run() {
    usable || make_venv
    touch "$unfinished"
    "$venv/bin/python" -m compileall -qq mfr_bench &
    find_uv
    install_dependencies requirements-run.lock
    compile_imports &
    probe_early &
    install_package
    wait
    rm -rf "$bundled" "$unfinished"
}

setup_python() {
    [ ! -e "$unfinished" ] || setup_run
    touch "$unfinished"
    find_uv
    install_dependencies requirements.lock
    rm "$unfinished"
}

# Looks for a driver while something else is done. What it finds counts for a minute.
probe_early() {
    "$venv/bin/python" -m mfr_bench.gpu.probe >"$venv/probing" 2>&1 && mv "$venv/probing" "$venv/probed"
}

# Sets `found` to what the probe printed. Fails where there is no driver; stops where the probe itself breaks.
probe() {
    status=0
    if [ -n "$(find "$venv/probed" -mmin -1 2>/dev/null)" ]; then
        found=$(cat "$venv/probed")
    else
        found=$("$venv/bin/python" -m mfr_bench.gpu.probe 2>&1) || status=$?
    fi
    rm -f "$venv/probed"
    case $status in
        0) say "$found" ;;
        3) return 1 ;;
        *) stop "looking for an OpenGL driver broke with status $status: $found" ;;
    esac
}

setup_driver() {
    packages="libegl1 libgl1 libgl1-mesa-dri"
    # shellcheck disable=SC2086 # several packages
    probe || { apt_install "no OpenGL >= 4.3 driver found" $packages && probe; } ||
        stop "$packages are installed, but still no OpenGL >= 4.3: $found"
}

# One at a time: a second make waits for the first. A file system without locks has none.
exec 9<.
flock --nonblock 9 2>/dev/null || [ $? != 1 ] || { say "waiting for another setup in $PWD"; flock 9; }

case ${1:-} in
    run) setup_run ;;
    python) setup_python ;;
    driver) setup_driver ;;
    *) stop "usage: scripts/setup.sh run|python|driver" ;;
esac
