#!/bin/sh
# Tests what llvmpipe has to skip (interlock, 64-bit atomics) on zink over lavapipe of the newest Mesa, in a root of
# Debian sid that stays for the next call. Exit status 1: a test failed; any other but 0: it could not be run here.
set -u
cd "$(dirname "$0")/.." || exit 3
if ! command -v debootstrap >/dev/null; then
    command -v apt-get >/dev/null && [ "$(id -u)" = 0 ] || exit 3
    apt-get -qq update && apt-get -qq install -y --no-install-recommends debootstrap debian-archive-keyring ||
        exit 3
fi
exec scripts/drivers.py --root sid --driver zink --check features --dir "${TMPDIR:-/var/tmp}/mfr-bench-drivers"
