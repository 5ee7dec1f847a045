#!/bin/sh
# A loop in a shader ends after 65,535 iterations, without an error.
#
# Seen with Mesa 22.3.6 (llvmpipe), moderngl 5.13.0, Python 3.11; the same with Mesa 24.0.5 and with zink over lavapipe
# 22.3.6, right with Mesa 25.0.7, 26.0.3 and 26.2.6:
#   llvmpipe (LLVM 15.0.6, 256 bits) 4.5 (Core Profile) Mesa 22.3.6
#   `for (; i < n; ++i)` ends at 65000 of 65000, 65535 of 70000, 65535 of 200000
# The loop is left as if its condition had become false, so that what follows it works on unfinished results.
#
# Needs root, debootstrap, and the network for Debian's packages and PyPI. Ends with status 1 if this changes.
set -eu
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
debootstrap --variant=minbase --include=ca-certificates,python3-venv,libegl1,libgl1,libgl1-mesa-dri \
    bookworm "$root" http://deb.debian.org/debian /usr/share/debootstrap/scripts/sid >"$root.log" 2>&1 ||
    { tail "$root.log"; exit 2; }
rm -f "$root.log"
cp /etc/resolv.conf "$root/etc/"
cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
cat >"$root/loop.py" <<'PYTHON'
import moderngl
import numpy as np

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
program = ctx.compute_shader("""#version 430
layout(local_size_x = 1) in;
uniform uint n;
layout(std430, binding = 0) buffer Ended { uint at; uint hash; };
void main() {
    uint i = 0u, mixed = 0u;
    for (; i < n; ++i) mixed ^= (mixed << 1) + i;
    at = i;
    hash = mixed;
}""")
ended = ctx.buffer(reserve=8)
ended.bind_to_storage_buffer(0)


def last(n):
    """The value of the counter behind a loop of n iterations."""
    program["n"] = n
    program.run(1)
    ctx.finish()
    ctx.memory_barrier()
    return int(np.frombuffer(ended.read(), dtype=np.uint32)[0])


found = {n: last(n) for n in (65000, 70000, 200000)}
print("`for (; i < n; ++i)` ends at", ", ".join(f"{at} of {n}" for n, at in found.items()))
raise SystemExit(0 if list(found.values()) == [65000, 65535, 65535] else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.3.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /loop.py' "$root"
