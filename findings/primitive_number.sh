#!/bin/sh
# A fragment shader that reads gl_PrimitiveID and an input sees each in the other's place.
#
# Seen with Mesa 26.0.3 (llvmpipe), moderngl 5.13.0, Python 3.14; right with Mesa 24.0.5, 25.0.7, 26.1.6 and 26.2.6:
#   llvmpipe (LLVM 21.1.8, 256 bits) 4.5 (Core Profile) Mesa 26.0.3-1ubuntu1
#   of 480 fragments 480 see the number alone, 0 the number and the input, 480 each in the other's place
# The number is the bits of the input at the triangle's last vertex, the input the number's bits taken for a float. A
# shader that reads the number alone is right.
#
# Needs root, debootstrap, dpkg-deb, and the network for Ubuntu's and Debian's packages and PyPI. Ends with status 1 if
# this changes.
set -eu
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
# The keys that Ubuntu signs with, for a system that has no package of them.
mkdir "$root/keys"
python3 - "$root/keys/keys.deb" <<'PYTHON'
import hashlib
import sys
import urllib.request

pool = "http://deb.debian.org/debian/pool/main/u/ubuntu-keyring"
package = urllib.request.urlopen(f"{pool}/ubuntu-keyring_2023.11.28.1-0.2_all.deb").read()
if hashlib.sha256(package).hexdigest() != "b2e7ed48431bf9e7978ae810bbdaf253093570d6e3f864e575b7c13554b81174":
    raise SystemExit("the package of Ubuntu's keys is another one")
open(sys.argv[1], "wb").write(package)
PYTHON
dpkg-deb -x "$root/keys/keys.deb" "$root/keys"
debootstrap --variant=minbase --force-check-gpg --components=main,universe \
    --keyring="$root/keys/usr/share/keyrings/ubuntu-archive-keyring.gpg" \
    --include=ca-certificates,python3-venv,libegl1,libgl1,libgl1-mesa-dri \
    resolute "$root/ubuntu" http://archive.ubuntu.com/ubuntu /usr/share/debootstrap/scripts/gutsy >"$root/log" 2>&1 ||
    { tail "$root/log"; exit 2; }
cp /etc/resolv.conf "$root/ubuntu/etc/"
cp /etc/ssl/certs/ca-certificates.crt "$root/ubuntu/etc/ssl/certs/"
cat >"$root/ubuntu/number.py" <<'PYTHON'
import moderngl
import numpy as np

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
width, height = 24, 20
pixels = width * height
vertex = """#version 430
out float across;
void main() {  // two triangles, one on each side of the diagonal
    vec2 corners[] = vec2[](vec2(0.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(1.0), vec2(0.0, 1.0), vec2(1.0, 0.0));
    vec2 corner = corners[gl_VertexID];
    across = 3.0 + corner.x;
    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}"""
fragment = """#version 430
layout(std430, binding = 0) buffer Seen { uvec2 seen[]; };
in float across;
out vec4 colour;
void main() {
    seen[uint(gl_FragCoord.y) * 24u + uint(gl_FragCoord.x)] = uvec2(uint(gl_PrimitiveID), INPUT);
    colour = vec4(1.0);
}"""
y, x = np.indices((height, width))
number = ((x + 0.5) / width + (y + 0.5) / height > 1.0).astype(np.uint32).ravel()
across = (3.0 + (x + 0.5) / width).astype(np.float32).ravel()
at_last_vertex = (3.0 + number).astype(np.float32).view(np.uint32)


def drawn(read):
    """uint32 (pixels,): the number that each pixel saw, and the bits of the input."""
    program = ctx.program(vertex_shader=vertex, fragment_shader=fragment.replace("INPUT", read))
    seen = ctx.buffer(bytes(8 * pixels))
    seen.bind_to_storage_buffer(0)
    ctx.framebuffer([ctx.texture((width, height), 4)]).use()
    ctx.vertex_array(program, []).render(moderngl.TRIANGLES, 6)
    ctx.finish()
    ctx.memory_barrier()
    return np.frombuffer(seen.read(), np.uint32).reshape(pixels, 2).T.copy()


alone, _ = drawn("0u")
numbers, inputs = drawn("floatBitsToUint(across)")
inputs = inputs.view(np.float32)
right = (numbers == number) & (abs(inputs - across) < 1e-5)
exchanged = (numbers == at_last_vertex) & (abs(inputs) < 1e-38)
print(f"of {pixels} fragments {(alone == number).sum()} see the number alone, {right.sum()} the number and the input, "
      f"{exchanged.sum()} each in the other's place")
raise SystemExit(0 if (alone == number).all() and exchanged.all() else 1)
PYTHON
chroot "$root/ubuntu" sh -c \
    'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.5.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /number.py' "$root/ubuntu"
