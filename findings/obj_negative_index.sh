#!/bin/sh
# trimesh counts a negative vertex index of an OBJ face from the end of the file, not from the face.
#
# The format counts -1 as the last vertex before the face. trimesh 5.2.0 resolves it after it has read all vertices, so
# that a file which declares vertices behind a face gives other triangles, without a warning. assimp-py 1.1.0 counts as
# the format says. Seen with Python 3.11:
#   trimesh:   [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 9.0, 9.0]]
#   assimp-py: [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
#
# Needs the network for PyPI. Ends with status 1 if this changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q install trimesh==5.2.0 "assimp-py==1.1.0; python_version < '3.12'" "assimp-py==1.2.0; python_version >= '3.12'" numpy
cat >"$folder/a.obj" <<'OBJ'
v 0 0 0
v 2 0 0
v 0 1 0
f -3 -2 -1
v 9 9 9
OBJ
"$folder/venv/bin/python" - "$folder/a.obj" <<'PYTHON'
import sys

import assimp_py
import numpy as np
import trimesh

mesh = trimesh.load(sys.argv[1], process=False, force="mesh")
other = mesh.vertices[mesh.faces[0]].tolist()
read = assimp_py.import_file(sys.argv[1], assimp_py.Process_Triangulate).meshes[0]
right = np.array(read.vertices).reshape(-1, 3)[np.array(read.indices)[:3]].tolist()
print("trimesh:  ", other)
print("assimp-py:", right)
expected = [[0, 0, 0], [2, 0, 0], [0, 1, 0]]
sys.exit(0 if right == expected and other != expected else 1)
PYTHON
