#!/bin/sh
# Blending by one and zero does not leave a colour as it is in a target of one 32-bit float channel.
#
# Seen with Mesa 22.3.6 (llvmpipe), moderngl 5.13.0, Python 3.11:
#   llvmpipe (LLVM 15.0.6, 256 bits) 4.5 (Core Profile) Mesa 22.3.6
#   1 channels, 0.1 over 0: 0.100000001, 1: 0.100000024, 10000: 0.099609375, 1e+30: 0, inf: nan
#   2 channels, 0.1 over 0: 0.100000001, 1: 0.100000001, 10000: 0.100000001, 1e+30: 0.100000001, inf: 0.100000001
#   4 channels, 0.1 over 0: 0.100000001, 1: 0.100000001, 10000: 0.100000001, 1e+30: 0.100000001, inf: 0.100000001
# What was there before ought to count for nothing, and does in targets of two and four channels. In one of one channel
# llvmpipe adds the difference between the new value and the old one to the old one: digits of the new one are lost, all
# of them beside a large old one, and an infinite old one gives NaN. (OpenGL lets the last alone: zero times infinity.)
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
cat >"$root/blended.py" <<'PYTHON'
import struct

import moderngl

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
program = ctx.program(
    vertex_shader="#version 430\n"
                  "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4 - 1, 0, 1); }",
    fragment_shader="#version 430\nout vec4 colour;\nvoid main() { colour = vec4(0.1); }")
triangle = ctx.vertex_array(program, [])


def drawn(channels, before):
    """The first channel after 0.1 is drawn over `before`, blended by one and zero."""
    target = ctx.texture((8, 8), channels, dtype="f4", data=struct.pack("f", before) * (64 * channels))
    ctx.framebuffer([target]).use()
    ctx.enable(moderngl.BLEND)
    ctx.blend_func = moderngl.ONE, moderngl.ZERO
    triangle.render(moderngl.TRIANGLES, vertices=3)
    return struct.unpack_from("f", target.read())[0]


olds = 0.0, 1.0, 1e4, 1e30, float("inf")
found = {channels: [drawn(channels, old) for old in olds] for channels in (1, 2, 4)}
for channels, values in found.items():
    print(f"{channels} channels, 0.1 over", ", ".join(f"{old:g}: {new:.9g}" for old, new in zip(olds, values)))
exact = {channels: len(set(values)) == 1 for channels, values in found.items()}
raise SystemExit(0 if exact == {1: False, 2: True, 4: True} and found[1][3] == 0.0 else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal MESA_SHADER_CACHE_DISABLE=true /venv/bin/python /blended.py' "$root"
