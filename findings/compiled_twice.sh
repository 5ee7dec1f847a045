#!/bin/sh
# A fragment shader that is drawn without blending is compiled by LLVM twice, one that is drawn with it once.
#
# Seen with Mesa 22.3.6 (llvmpipe), moderngl 5.13.0, Python 3.11:
#   llvmpipe (LLVM 15.0.6, 256 bits) 4.5 (Core Profile) Mesa 22.3.6
#   first draw: 85 ms without blending, 48 ms with one and zero: 1.75 times; images equal
# Without blending, depth test, stencil test and discard nothing below shows through, and llvmpipe compiles the program
# apart for blocks of pixels that a triangle covers whole, where the part without a mask of covered pixels saves little.
# Blending by one and zero, which leaves the colour as it is, makes one program do for both; the pixels are the same.
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
cat >"$root/twice.py" <<'PYTHON'
import time
from statistics import median

import moderngl

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
size, values = 64, 24
framebuffer = ctx.simple_framebuffer((size, size), 4, dtype="f4")
framebuffer.use()
vertex = "#version 430\nvoid main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4 - 1, 0, 1); }"


def fragment(seed):
    """Sorts so many values of each pixel by exchanging neighbours; the seed makes it another program."""
    swaps = [(i, i + 1) for turn in range(values) for i in range(turn % 2, values - 1, 2)]
    sets = "\n".join(f"float v{i} = fract(sin(dot(gl_FragCoord.xy, vec2({i + 1}.3, {seed}.7))) * 43.1);"
                     for i in range(values))
    orders = "\n".join(f"low = min(v{i}, v{j}); v{j} = max(v{i}, v{j}); v{i} = low;" for i, j in swaps)
    return (f"#version 430\nout vec4 colour;\nvoid main() {{ float low;\n{sets}\n{orders}\n"
            f"colour = vec4(v0, v{values // 2}, v{values - 1}, 1); }}")


def drawn(seed, blended):
    """Processor time of a program's first draw in s, and its pixels."""
    (ctx.enable if blended else ctx.disable)(moderngl.BLEND)
    ctx.blend_func = moderngl.ONE, moderngl.ZERO
    array = ctx.vertex_array(ctx.program(vertex_shader=vertex, fragment_shader=fragment(seed)), [])
    framebuffer.clear()
    ctx.finish()
    begun = time.process_time()
    array.render(moderngl.TRIANGLES, vertices=3)
    ctx.finish()
    return time.process_time() - begun, framebuffer.read(components=4, dtype="f4")


times = {blended: [] for blended in (False, True)}
for seed in range(1, 12):
    for blended in times:
        times[blended].append(drawn(2 * seed + blended, blended)[0])
plain_ms, blended_ms = (1e3 * median(times[blended]) for blended in (False, True))
same = drawn(0, False)[1] == drawn(0, True)[1]
print(f"first draw: {plain_ms:.0f} ms without blending, {blended_ms:.0f} ms with one and zero: {plain_ms / blended_ms:.2f}"
      f" times; images {'equal' if same else 'differ'}")
raise SystemExit(0 if same and plain_ms > 1.4 * blended_ms else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal MESA_SHADER_CACHE_DISABLE=true /venv/bin/python /twice.py' "$root"
