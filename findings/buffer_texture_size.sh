#!/bin/sh
# A program that reads a buffer through a texture is compiled again when the size of the buffer changes in certain bits.
#
# Seen with Mesa 22.3.6 (llvmpipe), moderngl 5.13.0, Python 3.11:
#   llvmpipe (LLVM 15.0.6, 256 bits) 4.5 (Core Profile) Mesa 22.3.6
#   compiled for: 320 128 256 not for: 200 240 640 1000 65736 196708 65536 4096
# Sizes are drawn one after another with the same program; the first draw of each is looked at. One that differs from an
# earlier one in size alone is compiled for again where bits 8 to 15 of the number of bytes are all zero in one and not in
# the other, as if they told whether there are mipmaps, or where just one of both is a power of two.
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
cat >"$root/size.py" <<'PYTHON'
import ctypes
import sys
import time
from ctypes.util import find_library

import moderngl

TEXTURE_BUFFER, R32UI = 0x8C2A, 0x8236
ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
gl = ctypes.CDLL(find_library("GL"))
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
vertex = """#version 430
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }"""
values = 24  # of each pixel, sorted by exchanges: so much to compile that a draw shows it
reads = "\n".join(f"uint v{i} = texelFetch(words, {i}).r ^ uint(gl_FragCoord.x * {i + 1}.7);" for i in range(values))
orders = "\n".join(f"low = min(v{i}, v{i + 1}); v{i + 1} = max(v{i}, v{i + 1}); v{i} = low;"
                   for turn in range(values) for i in range(turn % 2, values - 1, 2))
fragment = f"""#version 430
layout(binding = 0) uniform usamplerBuffer words;
out vec4 colour;
void main() {{ uint low;
{reads}
{orders}
colour = vec4(v0, v7, v15, v{values - 1}); }}"""
array = ctx.vertex_array(ctx.program(vertex_shader=vertex, fragment_shader=fragment), [])
ctx.framebuffer([ctx.texture((16, 16), 4, dtype="f4")]).use()


def draw_ms(size):
    """Processor time of a draw that reads a buffer of so many bytes."""
    name, buffer = ctypes.c_uint(), ctx.buffer(reserve=size)
    gl.glGenTextures(1, ctypes.byref(name))
    gl.glActiveTexture(0x84C0)
    gl.glBindTexture(TEXTURE_BUFFER, name)
    gl.glTexBuffer(TEXTURE_BUFFER, R32UI, buffer.glo)
    ctx.finish()
    begun = time.process_time()
    array.render(moderngl.TRIANGLES, 3)
    ctx.finish()
    return (time.process_time() - begun) * 1e3


SIZES = 200, 240, 320, 640, 1000, 65536 + 200, 3 * 65536 + 100, 128, 65536, 256, 4096
draw_ms(200)  # without the sampler that the first draw leaves
compiled = [draw_ms(size) > 15 for size in SIZES]
print("compiled for:", *(size for size, slow in zip(SIZES, compiled) if slow), "not for:",
      *(size for size, slow in zip(SIZES, compiled) if not slow))
sys.exit(0 if [size for size, slow in zip(SIZES, compiled) if slow] == [320, 128, 256] else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal MESA_SHADER_CACHE_DISABLE=true /venv/bin/python /size.py' "$root"
