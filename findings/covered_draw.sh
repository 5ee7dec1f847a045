#!/bin/sh
# A draw loses what its fragments store if an opaque draw covers it afterwards.
#
# Seen with Mesa 25.0.7 (llvmpipe), moderngl 5.13.0, Python 3.13; the same with Mesa 22.3.6, 24.0.5 and 26.2.6, and with
# zink over lavapipe 25.0.7 and 26.2.6:
#   llvmpipe (LLVM 19.1.7, 256 bits) 4.5 (Core Profile) Mesa 25.0.7-2+deb13u1
#   65536 of 65536 fragments counted; 49152 with an opaque draw behind, 49152 if no colour was written; 65536 with a
#   barrier between
# A fragment shader that counts in a storage block has to run for every fragment, whatever becomes of its colour. Where a
# later draw without blending covers a whole tile of 64 x 64 pixels, the earlier draw is dropped there together with its
# atomic operations, even if it writes no colour. glMemoryBarrier between the two draws keeps them.
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
cat >"$root/covered.py" <<'PYTHON'
import moderngl
import numpy as np

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
vertex = """#version 430
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }"""
count = ctx.program(vertex_shader=vertex, fragment_shader="""#version 430
layout(std430, binding = 0) buffer Counts { uint counts[]; };
out vec4 colour;
void main() {
    atomicAdd(counts[uint(gl_FragCoord.y) * 256u + uint(gl_FragCoord.x)], 1u);
    colour = vec4(0.5);
}""")
cover = ctx.program(vertex_shader=vertex, fragment_shader="""#version 430
out vec4 colour;
void main() { colour = vec4(1.0); }""")
size = 256
counts = ctx.buffer(reserve=4 * size * size)
counts.bind_to_storage_buffer(0)
target = ctx.framebuffer([ctx.texture((size, size), 4)])
counting, covering = (ctx.vertex_array(program, []) for program in (count, cover))


def counted(*after, colour=True):
    """The fragments that the first draw has counted once the other steps are done."""
    counts.write(bytes(4 * size * size))
    target.color_mask = (colour,) * 4
    target.use()
    counting.render(moderngl.TRIANGLES, 3)
    target.color_mask = (True,) * 4
    target.use()
    for step in after:
        step()
    ctx.finish()
    ctx.memory_barrier()
    return int(np.frombuffer(counts.read(), dtype=np.uint32).sum())


def opaque():
    covering.render(moderngl.TRIANGLES, 3)


alone, covered, uncoloured, kept = (counted(), counted(opaque), counted(opaque, colour=False),
                                    counted(ctx.memory_barrier, opaque))
print(f"{alone} of {size * size} fragments counted; {covered} with an opaque draw behind, {uncoloured} if no colour was "
      f"written; {kept} with a barrier between")
raise SystemExit(0 if alone == kept == size * size > max(covered, uncoloured) else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.3.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /covered.py' "$root"
