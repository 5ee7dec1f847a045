#!/bin/sh
# `d -halo 0.3`, one of the two forms in which MTL gives an opacity, is read in three ways, and by none as 0.3.
#
# The format has `d factor` and `d -halo factor`. Open Asset Import Library (assimp-py 1.1.0) refuses the whole model
# over it, although the OBJ is sound; tinyobjloader 2.0.0rc13 takes the opacity for 0, so that the model is invisible,
# without a warning; trimesh 5.2.0 keeps the words. Seen with Python 3.11:
#   assimp-py:     Cannot parse string "halo" as a real number
#   tinyobjloader: 0.0, warning ''
#   trimesh:       ['-halo', '0.3']
#
# Needs the network for PyPI, and a Python of which tinyobjloader has a wheel (3.9 to 3.12) or a C++ compiler. Ends with
# status 1 if this changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q install trimesh==5.2.0 tinyobjloader==2.0.0rc13 "assimp-py==1.1.0; python_version < '3.12'" "assimp-py==1.2.0; python_version >= '3.12'" numpy pillow
cat >"$folder/a.mtl" <<'MTL'
newmtl glass
Kd 0 0 1
d -halo 0.3
MTL
cat >"$folder/a.obj" <<'OBJ'
mtllib a.mtl
v 0 0 0
v 1 0 0
v 0 1 0
usemtl glass
f 1 2 3
OBJ
"$folder/venv/bin/python" - "$folder/a.obj" <<'PYTHON'
import sys

import assimp_py
import tinyobjloader
import trimesh

try:
    assimp_py.import_file(sys.argv[1], assimp_py.Process_Triangulate)
    refused = ""
except RuntimeError as error:
    refused = str(error)
reader = tinyobjloader.ObjReader()
reader.ParseFromFile(sys.argv[1])
opacity, warning = reader.GetMaterials()[0].dissolve, reader.Warning()
words = trimesh.load(sys.argv[1], force="mesh").visual.material.kwargs["d"]
print("assimp-py:    ", refused.partition(": ")[2] or "read")
print("tinyobjloader:", opacity, "warning", repr(warning))
print("trimesh:      ", words)
sys.exit(0 if "halo" in refused and opacity == 0 and not warning and words == ["-halo", "0.3"] else 1)
PYTHON
