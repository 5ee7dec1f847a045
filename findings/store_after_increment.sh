#!/bin/sh
# A loop stores an element of a local array where its counter points next, if it compares the next value before.
#
# Seen with Mesa 22.3.6 (llvmpipe), moderngl 5.13.0, Python 3.11; right with Mesa 25.0.7, others were not tried:
#   llvmpipe (LLVM 15.0.6, 256 bits) 4.5 (Core Profile) Mesa 22.3.6
#   asked behind the stores: 127 128 125 126 123 124 121 122 …, as it should be
#   asked before the stores: 128 128 127 127 125 125 123 123 …, as if held[i] were held[i + 2]
# The loop sorts each pair of an array in descending order. It ends by a bound, or by a break whose condition compares
# i + 2, the counter's next value. Where that is written before the stores, held[i] is stored at i + 2, and held[i + 1]
# where it belongs. The swap of swap_in_array.sh that leaves an array as it is stores its last element at i + 1 as well.
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
cat >"$root/store.py" <<'PYTHON'
import moderngl
import numpy as np

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
LENGTH = 128
SOURCE = """#version 430
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Elements { uint elements[]; };
uniform uint count;
void main() {
    uint held[LENGTH];
    for (uint i = 0u; i < count; ++i) held[i] = elements[i];
    for (uint i = 0u; i < count; i += 2u) {
        uint a = held[i], b = held[i + 1u];
        BODY
        if (!more) break;
    }
    for (uint i = 0u; i < count; ++i) elements[i] = held[i];
}"""
ASK, STORE = "bool more = i + 2u < count;", "held[i] = min(a, b); held[i + 1u] = max(a, b);"


def left_by(*body):
    """The array, in descending order before, as the loop leaves it."""
    program = ctx.compute_shader(SOURCE.replace("LENGTH", str(LENGTH)).replace("BODY", " ".join(body)))
    buffer = ctx.buffer(np.arange(LENGTH, 0, -1, dtype=np.uint32).tobytes())
    buffer.bind_to_storage_buffer(0)
    program["count"] = LENGTH
    program.run(1)
    ctx.finish()
    ctx.memory_barrier()
    return np.frombuffer(buffer.read(), np.uint32).tolist()


def stored(ahead):
    """What the loop leaves if it stores the first of a pair so many elements ahead of it."""
    held = list(range(LENGTH, 0, -1)) + [0] * ahead
    for i in range(0, LENGTH, 2):
        a, b = held[i : i + 2]
        held[i + ahead], held[i + 1] = min(a, b), max(a, b)
    return held[:LENGTH]


behind, before = left_by(STORE, ASK), left_by(ASK, STORE)
print("asked behind the stores:", *behind[:8], "…, as it should be" if behind == stored(0) else "…")
print("asked before the stores:", *before[:8], "…, as if held[i] were held[i + 2]" if before == stored(2) else "…")
raise SystemExit(0 if behind == stored(0) and before == stored(2) else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.3.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /store.py' "$root"
