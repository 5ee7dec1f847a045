#!/bin/sh
# trimesh keeps the low byte of a 16-bit colour of a PLY: a channel at half its range becomes 0.
#
# PLY lets a file choose the type of each property, and `ushort red` is as sound as `uchar red`. trimesh 5.2.0 converts
# the numbers to bytes modulo 256, without a warning: 65535 comes out as 255 and hides the fault, 32768 as 0, 25700 (39 %
# of the range) as 100 by chance. plyfile 1.1.5 gives the numbers as they are. Seen with Python 3.11:
#   plyfile: [65535, 32768, 25600]
#   trimesh: [255, 0, 0]
#
# Needs the network for PyPI. Ends with status 1 if this changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q install trimesh==5.2.0 plyfile==1.1.5 numpy
cat >"$folder/a.ply" <<'PLY'
ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
property ushort red
property ushort green
property ushort blue
element face 1
property list uchar int vertex_indices
end_header
0 0 0 65535 0 0
1 0 0 32768 0 0
0 1 0 25600 0 0
3 0 1 2
PLY
"$folder/venv/bin/python" - "$folder/a.ply" <<'PYTHON'
import sys

import plyfile
import trimesh

stored = plyfile.PlyData.read(sys.argv[1])["vertex"]["red"].tolist()
read = trimesh.load(sys.argv[1], process=False).visual.vertex_colors[:, 0].tolist()
print("plyfile:", stored)
print("trimesh:", read)
sys.exit(0 if stored == [65535, 32768, 25600] and read == [255, 0, 0] else 1)
PYTHON
