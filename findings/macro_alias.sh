#!/bin/sh
# Mesa's preprocessor refuses a directive behind the use of a macro that is another name of a macro with parameters.
#
# Seen with Mesa 22.3.6 (llvmpipe), moderngl 5.13.0, Python 3.11; the same with Mesa 26.2.6:
#   llvmpipe (LLVM 15.0.6, 256 bits) 4.5 (Core Profile) Mesa 22.3.6
#   by its own name, #endif next: accepted; by the other name, nothing next: accepted
#   by the other name, #endif next: syntax error, unexpected HASH_TOKEN; #define next: the same
# C's preprocessor (GCC 12.2) accepts all four: nothing follows the closing parenthesis.
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
cat >"$root/alias.py" <<'PYTHON'
import moderngl

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
MACROS = """#version 430
#define ADD(value) x += value;
#define TWICE(DO) DO(1.0) DO(2.0)
#define BOTH TWICE
out vec4 colour;
void main() {
    float x = 0.0;
"""
CASES = {
    "by its own name, #endif next": "#if 1\nTWICE(ADD)\n#endif\n",
    "by the other name, nothing next": "BOTH(ADD)\n",
    "by the other name, #endif next": "#if 1\nBOTH(ADD)\n#endif\n",
    "by the other name, #define next": "BOTH(ADD)\n#define LAST 1\n",
}


def answer(body):
    """What the compiler says of a shader with this body."""
    try:
        ctx.program(vertex_shader="#version 430\nvoid main() { gl_Position = vec4(0.0); }",
                    fragment_shader=MACROS + body + "    colour = vec4(x);\n}\n")
    except moderngl.Error as error:
        return "unexpected HASH_TOKEN" if "unexpected HASH_TOKEN" in str(error) else str(error)
    return "accepted"


found = {case: answer(body) for case, body in CASES.items()}
print(*(f"{case}: {said}" for case, said in found.items()), sep="\n")
raise SystemExit(0 if list(found.values()) == ["accepted"] * 2 + ["unexpected HASH_TOKEN"] * 2 else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /alias.py' "$root"
