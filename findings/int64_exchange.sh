#!/bin/sh
# GL_NV_shader_atomic_int64 exchanges, adds and compares-and-swaps int64_t only; uint64_t has minimum, maximum and the
# bitwise operations. The reference compiler accepts the calls with uint64_t all the same; only a driver refuses them.
#
# Seen with Mesa 25.0.7 (zink over lavapipe, Debian 13), glslangValidator 15.1.0, moderngl 5.13.0:
#   uint64_t: Add no, Min yes, Max yes, And yes, Or yes, Xor yes, Exchange no, CompSwap no
#   int64_t: Add yes, Min yes, Max yes, And yes, Or yes, Xor yes, Exchange yes, CompSwap yes
#   glslangValidator: atomicExchange(uint64_t, uint64_t) accepted
#
# Needs root, debootstrap, and the network for Debian's packages and PyPI. Ends with status 1 if this changes.
set -eu
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
packages=ca-certificates,python3-venv,libegl1,libgl1,libgl1-mesa-dri,mesa-vulkan-drivers,glslang-tools
debootstrap --variant=minbase --include=$packages trixie "$root" http://deb.debian.org/debian >"$root.log" 2>&1 ||
    { tail "$root.log"; exit 2; }
rm -f "$root.log"
cp /etc/resolv.conf "$root/etc/"
cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
cat >"$root/int64.py" <<'PYTHON'
import subprocess
from pathlib import Path

import moderngl

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
SHADER = """#version 450 core
#extension GL_ARB_gpu_shader_int64 : enable
#extension GL_NV_shader_atomic_int64 : enable
layout(local_size_x = 1) in;
layout(std430, binding = 0) coherent buffer Words {{ {type} words[]; }};
void main() {{ atomic{operation}(words[0], {arguments}); }}
"""


def shader(type, operation):
    arguments = ", ".join([f"{type}(1)"] * (2 if operation == "CompSwap" else 1))
    return SHADER.format(type=type, operation=operation, arguments=arguments)


def compiles(type, operation):
    try:
        ctx.compute_shader(shader(type, operation)).release()
    except moderngl.Error:
        return False
    return True


OPERATIONS = ("Add", "Min", "Max", "And", "Or", "Xor", "Exchange", "CompSwap")
found = {type: {o: compiles(type, o) for o in OPERATIONS} for type in ("uint64_t", "int64_t")}
for type, taken in found.items():
    print(f"{type}:", ", ".join(f"{name} {'yes' if ok else 'no'}" for name, ok in taken.items()))
Path("/exchange.comp").write_text(shader("uint64_t", "Exchange"))
accepted = subprocess.run(["glslangValidator", "/exchange.comp"], capture_output=True).returncode == 0
print("glslangValidator: atomicExchange(uint64_t, uint64_t)", "accepted" if accepted else "refused")
lacking = [name for name, ok in found["uint64_t"].items() if not ok]
as_seen = lacking == ["Add", "Exchange", "CompSwap"] and all(found["int64_t"].values()) and accepted
raise SystemExit(0 if as_seen else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env MESA_LOADER_DRIVER_OVERRIDE=zink LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /int64.py' "$root"
