#!/bin/sh
# The length of a storage block is wrong in some invocations behind a loop that others have left.
#
# Seen with Mesa 26.1.6 (zink over lavapipe), moderngl 5.13.0, Python 3.14; right with Mesa 25.0.7 and 26.2.6:
#   zink Vulkan 1.4(llvmpipe ...) 4.6 (Core Profile) Mesa 26.1.6-1
#   second.length(): 478 of 480 invocations see 1000, 2 see 4000; 6 of 1000 words were not written
# A loop `for (i = p; i < uint(second.length()) && i < bound; i += pixels)` behind such a loop skips words: some lanes
# take the size in bytes for the number of elements, others end early. Passing the number as a uniform avoids it.
#
# Needs root, debootstrap, and the network for Debian's packages and PyPI. Ends with status 1 if this changes.
set -eu
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
debootstrap --variant=minbase --include=ca-certificates,python3-venv,libegl1,libgl1,libgl1-mesa-dri,mesa-vulkan-drivers \
    forky "$root" http://deb.debian.org/debian /usr/share/debootstrap/scripts/sid >"$root.log" 2>&1 ||
    { tail "$root.log"; exit 2; }
rm -f "$root.log"
cp /etc/resolv.conf "$root/etc/"
cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
cat >"$root/length.py" <<'PYTHON'
import moderngl
import numpy as np

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
width, height, words = 24, 20, 1000
pixels = width * height
program = ctx.program(
    vertex_shader="#version 430\nvoid main() {"
    "gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }",
    fragment_shader="""#version 430
layout(std430, binding = 0) buffer First { uint first[]; };
layout(std430, binding = 1) buffer Second { uint second[]; };
layout(std430, binding = 2) buffer Seen { uint seen[]; };
uniform uint pixels;
out vec4 colour;
void main() {
    uint p = uint(gl_FragCoord.y) * 24u + uint(gl_FragCoord.x);
    for (uint i = p; i < uint(first.length()) && i < 100000u; i += pixels) first[i] = 1u;
    for (uint i = p; i < uint(second.length()) && i < 100000u; i += pixels) second[i] = 2u;
    seen[p] = uint(second.length());
    colour = vec4(1.0);
}""")
program["pixels"] = pixels
buffers = [ctx.buffer(bytes(4 * count)) for count in (8 * pixels + 5, words, pixels)]
for binding, buffer in enumerate(buffers):
    buffer.bind_to_storage_buffer(binding)
ctx.framebuffer([ctx.texture((width, height), 4)]).use()
ctx.vertex_array(program, []).render(moderngl.TRIANGLES, 3)
ctx.finish()
ctx.memory_barrier()
second, seen = (np.frombuffer(buffer.read(), dtype=np.uint32) for buffer in buffers[1:])
right, wrong = int((seen == words).sum()), seen[seen != words]
missed = int((second != 2).sum())
print(f"second.length(): {right} of {pixels} invocations see {words}, {len(wrong)} see "
      f"{', '.join(map(str, np.unique(wrong))) or 'another'}; {missed} of {words} words were not written")
raise SystemExit(0 if missed else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.5.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env MESA_LOADER_DRIVER_OVERRIDE=zink LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /length.py' "$root"
