#!/bin/sh
# A timer query of a software driver contains a part of the work only.
#
# Seen with Mesa 25.0.7 (llvmpipe), moderngl 5.13.0, Python 3.13; the same with Mesa 22.3.6, 24.0.5, 26.0.3 and 26.2.6:
#   llvmpipe (LLVM 19.1.7, 256 bits) 4.5 (Core Profile) Mesa 25.0.7-2+deb13u1
#   64 x 64 pixels: 0.84 ms by GL_TIME_ELAPSED, 0.96 ms by the wall; 512 x 512: 39.6 ms by GL_TIME_ELAPSED, 574.2 ms by
#   the wall
# The result varies and is that of some tiles of 64 x 64 pixels, whatever their number. Methods that are
# compared by it look equal, or 50 times too fast. zink over lavapipe agrees with the wall.
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
cat >"$root/timer.py" <<'PYTHON'
import time

import moderngl

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
program = ctx.program(vertex_shader="""#version 430
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }""",
                      fragment_shader="""#version 430
out vec4 colour;
void main() {
    float x = gl_FragCoord.x;
    for (int i = 0; i < 100; ++i) x = sin(x) + 1.0;
    colour = vec4(x);
}""")
screen, query = ctx.vertex_array(program, []), ctx.query(time=True)


def times_ms(size):
    """The least of several times of one draw, by the query and by the wall between two finishes."""
    ctx.framebuffer([ctx.texture((size, size), 4)]).use()
    found = []
    for _ in range(10):
        ctx.finish()
        begun = time.perf_counter()
        with query:
            screen.render(moderngl.TRIANGLES, 3)
        ctx.finish()
        found.append((query.elapsed / 1e6, (time.perf_counter() - begun) * 1e3))
    return tuple(map(min, zip(*found[1:])))  # the first query of a context is of no use


(small, small_wall), (large, large_wall) = times_ms(64), times_ms(512)
print(f"64 x 64 pixels: {small:.2f} ms by GL_TIME_ELAPSED, {small_wall:.2f} ms by the wall; "
      f"512 x 512: {large:.1f} ms by GL_TIME_ELAPSED, {large_wall:.1f} ms by the wall")
raise SystemExit(0 if large < large_wall / 2 else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.3.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /timer.py' "$root"
