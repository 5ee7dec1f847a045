#!/bin/sh
# What a loop has read from a storage block is 0 behind it, in the lanes that left the loop before others.
#
# Seen with Mesa 25.0.7 (llvmpipe), moderngl 5.13.0, Python 3.13; right with Mesa 24.0.5, 26.0.3, 26.1.6 and 26.2.6:
#   llvmpipe (LLVM 19.1.7, 256 bits) 4.5 (Core Profile) Mesa 25.0.7-2+deb13u1
#   of 256 lanes 36 see the element behind the loop, 220 see 0; 256 see it if it is read before
# All lanes have the right sum. The element of a readonly block is read in each turn of the loop, for the lanes that are
# still in it alone; the others get 0. The compiler does not read it again behind the loop, but takes what the last turn
# has read for what all lanes have. Mesa 22.3.6 (llvmpipe, and zink over lavapipe) does so even with a variable that the
# loop sets to the element that it read last. Reading the element before the loop avoids the first.
#
# Needs root, debootstrap, and the network for Debian's packages and PyPI. Ends with status 1 if this changes.
set -eu
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
debootstrap --variant=minbase --include=ca-certificates,python3-venv,libegl1,libgl1,libgl1-mesa-dri \
    trixie "$root" http://deb.debian.org/debian /usr/share/debootstrap/scripts/sid >"$root.log" 2>&1 ||
    { tail "$root.log"; exit 2; }
rm -f "$root.log"
cp /etc/resolv.conf "$root/etc/"
cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
cat >"$root/loop.py" <<'PYTHON'
import moderngl
import numpy as np

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
lanes = 256
source = """#version 430
layout(std430, binding = 0) readonly buffer First { uint first[]; };
layout(std430, binding = 1) readonly buffer Words { uint words[]; };
layout(std430, binding = 2) writeonly buffer Seen { uvec2 seen[]; };
layout(local_size_x = 64) in;
void main() {
    uint p = gl_GlobalInvocationID.x, at = 0u, sum = 0u;
    BEFORE
    while (true) {
        sum += words[FIRST + at];
        if (++at > p % 7u) break;
    }
    seen[p] = uvec2(sum, FIRST);
}"""
first = (1000 + 3 * np.arange(lanes)).astype(np.uint32)
turns = np.arange(lanes) % 7 + 1
sums = first * turns + turns * (turns - 1) // 2


def seen(before, name):
    """Whether each lane has the right sum, and the element that it sees behind the loop."""
    program = ctx.compute_shader(source.replace("BEFORE", before).replace("FIRST", name))
    words = np.arange(4096, dtype=np.uint32)
    buffers = [ctx.buffer(data) for data in (first.tobytes(), words.tobytes(), bytes(8 * lanes))]
    for binding, buffer in enumerate(buffers):
        buffer.bind_to_storage_buffer(binding)
    program.run(lanes // 64)
    ctx.finish()
    ctx.memory_barrier()
    sum_, element = np.frombuffer(buffers[2].read(), np.uint32).reshape(lanes, 2).T
    return (sum_ == sums).all(), element


summed, element = seen("", "first[p]")
summed_before, element_before = seen("uint element = first[p];", "element")
right, zero, before = (element == first).sum(), (element == 0).sum(), (element_before == first).sum()
print(f"of {lanes} lanes {right} see the element behind the loop, {zero} see 0; {before} see it if it is read before")
raise SystemExit(0 if summed and summed_before and zero and right + zero == before == lanes else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.3.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /loop.py' "$root"
