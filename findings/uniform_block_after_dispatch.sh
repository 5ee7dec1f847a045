#!/bin/sh
# A uniform block contains a storage buffer of the dispatch before the draw.
#
# Seen with Mesa 25.0.7 (zink over lavapipe), moderngl 5.13.0, Python 3.13; the same with Mesa 24.0.5, 26.0.3, 26.1.6 and
# 26.2.6, right with 22.3.6 and on llvmpipe:
#   zink Vulkan 1.4(llvmpipe ...) 4.6 (Core Profile) Mesa 25.0.7-2+deb13u1
#   the block holds 11; after a dispatch that stores 16, a draw sees 16; behind a flush, 11
# A draw uses a uniform block and a storage block, a dispatch uses both as well, and a second draw uses the uniform block
# alone. Its fragment shader then reads what the dispatch has bound to the storage block. Nothing is bound to the uniform
# block in between, and glMemoryBarrier(GL_ALL_BARRIER_BITS) does not help; a glFlush after the dispatch does.
#
# Needs root, debootstrap, and the network for Debian's packages and PyPI. Ends with status 1 if this changes.
set -eu
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
debootstrap --variant=minbase --include=ca-certificates,python3-venv,libegl1,libgl1,libgl1-mesa-dri,mesa-vulkan-drivers \
    trixie "$root" http://deb.debian.org/debian /usr/share/debootstrap/scripts/sid >"$root.log" 2>&1 ||
    { tail "$root.log"; exit 2; }
rm -f "$root.log"
cp /etc/resolv.conf "$root/etc/"
cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
cat >"$root/block.py" <<'PYTHON'
import ctypes
from ctypes.util import find_library

import moderngl
import numpy as np

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
flush = ctypes.CDLL(find_library("GL")).glFlush
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
uniform = "#version 430\nlayout(std140, binding = 0) uniform Block { uint number; };\n"
storage = "layout(std430, binding = 0) buffer Storage { uint word; };\n"
vertex = uniform + """void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, number == 0u ? 0.5 : 0.0, 1.0); }"""
store = ctx.program(vertex_shader=vertex, fragment_shader=uniform + storage +
                    "out vec4 colour; void main() { word = number; colour = vec4(0.0); }")
show = ctx.program(vertex_shader=vertex, fragment_shader=uniform +
                   "out vec4 colour; void main() { colour = vec4(number); }")
compute = ctx.compute_shader(uniform + storage + "layout(local_size_x = 1) in; void main() { word = number + 5u; }")
block, first, second = (ctx.buffer(np.full(4, value, dtype=np.uint32)) for value in (11, 22, 33))
block.bind_to_uniform_block(0)
storing, showing = (ctx.vertex_array(program, []) for program in (store, show))
target = ctx.framebuffer([ctx.texture((4, 4), 4, dtype="f4")])
target.use()


def seen(between):
    """The number that the second draw sees."""
    ctx.finish()
    first.bind_to_storage_buffer(0)
    storing.render(moderngl.TRIANGLES, 3)
    second.bind_to_storage_buffer(0)
    ctx.memory_barrier()
    compute.run(1)
    ctx.memory_barrier()
    between()
    showing.render(moderngl.TRIANGLES, 3)
    return int(np.frombuffer(target.read(components=1, dtype="f4"), dtype=np.float32)[0])


plain, flushed = seen(lambda: None), seen(flush)
print(f"the block holds 11; after a dispatch that stores 16, a draw sees {plain}; behind a flush, {flushed}")
raise SystemExit(0 if (plain, flushed) == (16, 11) else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.5.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env MESA_LOADER_DRIVER_OVERRIDE=zink LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /block.py' "$root"
