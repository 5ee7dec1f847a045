#!/bin/sh
# A loop that swaps neighbours in a local array of 32 elements or more leaves them as they are, if written in one way.
#
# Seen with Mesa 22.3.6 (llvmpipe), moderngl 5.13.0, Python 3.11; other versions were not tried:
#   llvmpipe (LLVM 15.0.6, 256 bits) 4.5 (Core Profile) Mesa 22.3.6
#   of 31 elements the first is last after `i <= count - 2`, >=: yes, `i <= count - 2`, >: yes, `i + 1 < count`, >=: yes
#   of 32 elements the first is last after `i <= count - 2`, >=: no, `i <= count - 2`, >: yes, `i + 1 < count`, >=: yes
# The loop goes once over an array in descending order, which brings the first element to the end, as the inner loop of
# bubble sort does. All elements differ, so that both conditions are the same, and both bounds are the same anyway.
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
cat >"$root/swap.py" <<'PYTHON'
import moderngl
import numpy as np

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
SOURCE = """#version 430
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Elements { uint elements[]; };
uniform int count;
void main() {
    uint held[LENGTH];
    for (int i = 0; i < count; ++i) held[i] = elements[i];
    for (int i = 0; BOUND; ++i)
        if (held[i] COMPARED held[i + 1]) {
            uint next = held[i + 1];
            held[i + 1] = held[i];
            held[i] = next;
        }
    for (int i = 0; i < count; ++i) elements[i] = held[i];
}"""


def moved(length, bound, compared):
    """Whether one pass of swaps over an array in descending order brings its first element to the end."""
    source = SOURCE.replace("LENGTH", str(length)).replace("BOUND", bound).replace("COMPARED", compared)
    program = ctx.compute_shader(source)
    elements = np.arange(length, 0, -1, dtype=np.uint32)
    buffer = ctx.buffer(elements.tobytes())
    buffer.bind_to_storage_buffer(0)
    program["count"] = length
    program.run(1)
    ctx.finish()
    ctx.memory_barrier()
    return bool((np.frombuffer(buffer.read(), np.uint32) == np.roll(elements, -1)).all())


ways = [("i <= count - 2", ">="), ("i <= count - 2", ">"), ("i + 1 < count", ">=")]
right = {length: [moved(length, *way) for way in ways] for length in (31, 32)}
for length, moves in right.items():
    told = ", ".join(f"`{bound}`, {sign}: {'yes' if move else 'no'}" for (bound, sign), move in zip(ways, moves))
    print(f"of {length} elements the first is last after {told}")
raise SystemExit(0 if right == {31: [True, True, True], 32: [False, True, True]} else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.3.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /swap.py' "$root"
