#!/bin/sh
# LLVM 21 gives the constant -1 a vector register that the instruction which loads it cannot reach: another one changes.
#
# Seen with Mesa 26.1.6 and LLVM 21.1.8 (llvmpipe; Mesa 26.0.3 is the same) on a processor with AVX-512, moderngl 5.13.0;
# right with LLVM 17.0.6, 19.1.7 and 22.1.8 under Mesa 24.0.5, 25.0.7 and 26.2.6:
#   llvmpipe (LLVM 21.1.8, 256 bits) 4.6 (Core Profile) Mesa 26.1.6-1
#   of 9 words each list has 6 left after all were read; with GALLIUM_OVERRIDE_CPU_CAPS=avx 0
# A shader reads a list of 9 words into 16 variables, sorts eight of them and composites all. `at++` becomes a subtraction
# of -1. Under pressure the register allocator loads -1 once more, into one of ymm16 to ymm31, by AVX2_SETALLONES, which
# has no encoding for these (llc -verify-machineinstrs complains of the register class). The bytes that are emitted name
# the register 16 below, such as ymm11 for ymm27: ymm27 keeps what it held, and what ymm11 held is lost. The last loop is
# bounded, since it may otherwise not end.
#
# Needs root, debootstrap, a processor with AVX-512, and the network for Debian's packages and PyPI. Ends with status 1 if
# this changes.
set -eu
grep -q '^flags.* avx512vl' /proc/cpuinfo || { echo "this processor has no AVX-512, without which nothing shows"; exit 2; }
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
debootstrap --variant=minbase --include=ca-certificates,python3-venv,libegl1,libgl1,libgl1-mesa-dri \
    forky "$root" http://deb.debian.org/debian /usr/share/debootstrap/scripts/sid >"$root.log" 2>&1 ||
    { tail "$root.log"; exit 2; }
rm -f "$root.log"
cp /etc/resolv.conf "$root/etc/"
cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
cat >"$root/lists.py" <<'PYTHON'
import moderngl
import numpy as np

ctx = moderngl.create_standalone_context(require=430, backend="egl", device_index=0)
side, words = 16, 9
pixels = side * side
each = range(16)
network = [(0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (1, 2), (5, 6),
           (0, 4), (1, 5), (2, 6), (3, 7), (2, 4), (3, 5), (1, 2), (3, 4), (5, 6)]
program = ctx.compute_shader("""#version 430
layout(std430, binding = 0) readonly buffer Counts { uint count[]; };
layout(std430, binding = 1) readonly buffer Ends { uint ends[]; };
layout(std430, binding = 2) readonly buffer Lists { uvec2 list[]; };
layout(std430, binding = 3) buffer Left { uint left; };
layout(binding = 0) uniform sampler2D chosen;
layout(rgba32f, binding = 0) writeonly uniform image2D image;
layout(local_size_x = 8, local_size_y = 8) in;
uniform uint columns, rows;
uint at, end;
uvec2 block[16];

bool next(out uvec2 word) {
    if (at >= end) return false;
    word = list[at++];
    return true;
}

#define LOAD(i) found = found && next(word); block[i] = found ? word : uvec2(4294967295u, 0u);
#define SORT(a, b) { uvec2 low = block[a], high = block[b]; bool swapped = high.x < low.x; \\
    block[a] = swapped ? high : low; block[b] = swapped ? low : high; }
#define BLEND(i) { vec4 s = unpackUnorm4x8(block[i].y); \\
    colour = vec4(colour.rgb + colour.a * s.rgb * s.a, colour.a * (1.0 - s.a)); }

vec4 blended(uint p) {
    end = ends[p];
    at = end - count[p];
    bool found = true;
    uvec2 word;
    """ + " ".join(f"LOAD({i})" for i in each) + " ".join(f"SORT({a}, {b})" for a, b in network) + """
    vec4 colour = vec4(0.0, 0.0, 0.0, 1.0);
    if (found) {
        uint more = 0u;
        while (more < 64u && next(word)) ++more;
        if (more > 0u) atomicAdd(left, more);
    }
    """ + " ".join(f"BLEND({i})" for i in each) + """
    return vec4(colour.rgb, 1.0 - colour.a);
}

void main() {
    for (uint number = gl_WorkGroupID.x; number < (columns / 8u) * (rows / 8u); number += gl_NumWorkGroups.x) {
        uvec2 xy = 8u * uvec2(number % (columns / 8u), number / (columns / 8u)) + gl_LocalInvocationID.xy;
        if (xy.x < columns && xy.y < rows && texelFetch(chosen, ivec2(xy), 0).x == 0.0625)
            imageStore(image, ivec2(xy), blended(xy.y * columns + xy.x));
    }
}""")
program["columns"] = program["rows"] = side
numbers = np.arange(pixels * words, dtype=np.uint32)
arrays = (np.full(pixels, words, np.uint32), np.arange(1, pixels + 1, dtype=np.uint32) * np.uint32(words),
          np.stack([numbers, numbers * np.uint32(2654435761)], axis=1), np.zeros(1, np.uint32))
buffers = [ctx.buffer(array.tobytes()) for array in arrays]
for binding, buffer in enumerate(buffers):
    buffer.bind_to_storage_buffer(binding)
ctx.texture((side, side), 1, np.full(pixels, 0.0625, np.float32).tobytes(), dtype="f4").use(0)
ctx.texture((side, side), 4, dtype="f4").bind_to_image(0, read=False, write=True)
program.run(4)
ctx.finish()
ctx.memory_barrier()
print(ctx.info["GL_RENDERER"], ctx.info["GL_VERSION"])
print(int(np.frombuffer(buffers[-1].read(), np.uint32)[0]) / pixels)
PYTHON
chroot "$root" sh -c 'python3 -m venv /venv && /venv/bin/pip -q install moderngl==5.13.0 glcontext==3.1.0 numpy==2.5.5'
seen() {
    unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" \
        env EGL_LOG_LEVEL=fatal "$1" timeout -k 5 60 /venv/bin/python /lists.py' "$root" "$1"
}
plain=$(seen A=1)
narrow=$(seen GALLIUM_OVERRIDE_CPU_CAPS=avx)
echo "$plain" | head -n 1
echo "of 9 words each list has $(echo "$plain" | tail -n 1) left after all were read;" \
    "with GALLIUM_OVERRIDE_CPU_CAPS=avx $(echo "$narrow" | tail -n 1)"
test "$(echo "$plain" | tail -n 1)" != 0.0 && test "$(echo "$narrow" | tail -n 1)" = 0.0
