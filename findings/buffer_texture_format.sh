#!/bin/sh
# A texture of a buffer is read in the format of another texture of the same buffer, which the draw before has used.
#
# Seen with Mesa 25.0.7 (zink over lavapipe), moderngl 5.13.0, Python 3.13; the same with Mesa 24.0.5, 26.0.3, 26.1.6 and
# 26.2.6, right with 22.3.6 and on llvmpipe:
#   zink Vulkan 1.4(llvmpipe ...) 4.6 (Core Profile) Mesa 25.0.7-2+deb13u1
#   element 1 behind a draw: [5, 6]; behind a flush: [3, 4]
# A buffer holds 1 to 8. One texture shows it as RGBA32UI, a second one as RG32UI. A draw samples the first, the next draw
# another program and the second: it gets words 5 and 6, the element of the first format, where 3 and 4 are those of its
# own. Other units do not help, nor does binding nothing in between; a glFlush between the draws does.
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
cat >"$root/format.py" <<'PYTHON'
import ctypes
import sys
from ctypes.util import find_library

import moderngl
import numpy as np

TEXTURE_BUFFER, RG32UI, RGBA32UI = 0x8C2A, 0x823C, 0x8D70
ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
gl = ctypes.CDLL(find_library("GL"))
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
vertex = """#version 430
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }"""
fragment = """#version 430
layout(binding = 0) uniform usamplerBuffer texels;
out vec4 colour;
void main() { colour = vec4(texelFetch(texels, %d)); }"""
pair, single = (ctx.program(vertex_shader=vertex, fragment_shader=fragment % at) for at in (0, 1))
words = ctx.buffer(np.arange(1, 9, dtype=np.uint32))
names = (ctypes.c_uint * 2)()
gl.glGenTextures(2, names)
for name, kind in zip(names, (RGBA32UI, RG32UI)):
    gl.glBindTexture(TEXTURE_BUFFER, name)
    gl.glTexBuffer(TEXTURE_BUFFER, kind, words.glo)
drawing = {program: ctx.vertex_array(program, []) for program in (pair, single)}
target = ctx.framebuffer([ctx.texture((4, 4), 4, dtype="f4")])
target.use()


def draw(program, name):
    gl.glActiveTexture(0x84C0)
    gl.glBindTexture(TEXTURE_BUFFER, name)
    drawing[program].render(moderngl.TRIANGLES, 3)


def seen(between):
    """What a draw reads at element 1 of the texture of two words, behind a draw with that of four."""
    ctx.finish()
    draw(pair, names[0])
    between()
    draw(single, names[1])
    return [int(v) for v in np.frombuffer(target.read(components=4, dtype="f4"), dtype=np.float32)[:2]]


behind_draw, behind_flush = seen(lambda: None), seen(gl.glFlush)
print(f"element 1 behind a draw: {behind_draw}; behind a flush: {behind_flush}")
sys.exit(0 if (behind_draw, behind_flush) == ([5, 6], [3, 4]) else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.5.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env MESA_LOADER_DRIVER_OVERRIDE=zink LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /format.py' "$root"
