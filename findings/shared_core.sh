#!/bin/sh
# The threads of llvmpipe share one core after a pause, and a short frame takes nearly twice as long.
#
# Seen with Mesa 25.0.7 (llvmpipe, 2 threads on 2 processors), moderngl 5.13.0, Python 3.13:
#   llvmpipe (LLVM 19.1.7, 256 bits) 4.5 (Core Profile) Mesa 25.0.7-2+deb13u1
#   2 threads; frames of 1.64 ms; over 1.4 times as long after 94 of 100 pauses, 5.5 times at most; with each thread
#   bound after 1
# (the machine had other work meanwhile; without any, a fourth to a half of the pauses, up to 1.9 times)
# Mesa binds none of these threads, and the kernel wakes both where they ran last; it parts them after milliseconds, so
# that even the least of five frames of a ms or two after a pause is too long. A benchmark that pauses between methods,
# as for compiling, times short frames in one state or the other. Binding each thread to a processor of its own ends
# that.
#
# Needs root, debootstrap, two processors with nothing else to do, and the network for Debian's packages and PyPI. Ends
# with status 1 if this changes.
set -eu
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
debootstrap --variant=minbase --include=ca-certificates,python3-venv,libegl1,libgl1,libgl1-mesa-dri \
    trixie "$root" http://deb.debian.org/debian /usr/share/debootstrap/scripts/sid >"$root.log" 2>&1 ||
    { tail "$root.log"; exit 2; }
rm -f "$root.log"
cp /etc/resolv.conf "$root/etc/"
cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
cat >"$root/shared.py" <<'PYTHON'
import os
import time
from pathlib import Path

import moderngl

cpus = sorted(os.sched_getaffinity(0))[:2]
if len(cpus) < 2:
    raise SystemExit("needs two processors")
os.sched_setaffinity(0, cpus)
ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
program = ctx.program(vertex_shader="""#version 430
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }""",
                      fragment_shader="""#version 430
out vec4 colour;
void main() {
    float x = gl_FragCoord.x;
    for (int i = 0; i < 400; ++i) x = fract(x * 1.7 + 0.3);
    colour = vec4(x);
}""")
screen = ctx.vertex_array(program, [])
ctx.framebuffer([ctx.texture((128, 128), 4)]).use()
threads = [int(task.name) for task in Path("/proc/self/task").iterdir()
           if (task / "comm").read_text().startswith("llvmpipe-")]


def frame_ms():
    begun = time.perf_counter()
    screen.render(moderngl.TRIANGLES, 3)
    ctx.finish()
    return (time.perf_counter() - begun) * 1e3


def after_pauses(masks, count=50):
    """The least of five frames after each of so many pauses, with these processors for the threads."""
    for thread, mask in zip(threads, masks):
        os.sched_setaffinity(thread, mask)
    found = []
    for _ in range(count):
        time.sleep(0.1)
        found.append(min(frame_ms() for _ in range(5)))
    return found


free, bound = [], []
for _ in range(2):
    free += after_pauses([cpus, cpus])
    bound += after_pauses([[cpu] for cpu in cpus])
usual = sorted(bound)[len(bound) // 2]
slow = {name: sum(ms > 1.4 * usual for ms in times) for name, times in (("free", free), ("bound", bound))}
print(f"{len(threads)} threads; frames of {usual:.2f} ms; over 1.4 times as long after {slow['free']} of {len(free)} "
      f"pauses, {max(free) / usual:.1f} times at most; with each thread bound after {slow['bound']}")
raise SystemExit(0 if len(threads) == 2 and slow["free"] >= 10 and slow["bound"] <= slow["free"] / 4 else 1)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.3.5'
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
    env LIBGL_ALWAYS_SOFTWARE=1 EGL_LOG_LEVEL=fatal /venv/bin/python /shared.py' "$root"
