#!/bin/sh
# Two readers of glTF pass on the alpha of materials for which the format says that it is to be ignored.
#
# By glTF 2.0 §3.9.4 a material without alphaMode is OPAQUE, and the alpha of its colour is ignored; only BLEND blends.
# assimp-py 1.1.0 gives three materials that differ in alphaMode alone the same properties: several properties share one
# key, of which the last survives, and the mode is gone. trimesh 5.2.0 keeps the mode as text and leaves the colour's
# alpha at 128 for all three. Seen with Python 3.11:
#   assimp-py: opacities [0.5, 0.5, 0.5], alphaMode in any key or value: False
#   trimesh:   alphas [128, 128, 128], modes [None, 'OPAQUE', 'BLEND']
#
# Needs the network for PyPI. Ends with status 1 if this changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q install trimesh==5.2.0 "assimp-py==1.1.0; python_version < '3.12'" "assimp-py==1.2.0; python_version >= '3.12'" numpy pillow
"$folder/venv/bin/python" - "$folder" <<'PYTHON'
import base64
import json
import struct
import sys
from pathlib import Path

import assimp_py
import trimesh

corners = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
colour = {"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]}}
materials = [dict(colour, name="first"), dict(colour, name="second", alphaMode="OPAQUE"),
             dict(colour, name="third", alphaMode="BLEND")]
document = {
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}], "nodes": [{"mesh": i} for i in range(3)],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + base64.b64encode(corners).decode()}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}], "materials": materials,
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                   "max": [1, 1, 0]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": i}]} for i in range(3)]}
path = Path(sys.argv[1], "a.gltf")
path.write_text(json.dumps(document))

found = [m for m in assimp_py.import_file(str(path), 0).materials if m.get("NAME") in ("first", "second", "third")]
opacities = [m.get("OPACITY") for m in found]
told = any(word in repr(m).upper() for m in found for word in ("ALPHAMODE", "'BLEND'", "'OPAQUE'"))
print(f"assimp-py: opacities {opacities}, alphaMode in any key or value: {told}")
kept = {g.visual.material.name: g.visual.material for g in trimesh.load(path, process=False).geometry.values()}
alphas = [int(kept[name].baseColorFactor[3]) for name in ("first", "second", "third")]
modes = [kept[name].alphaMode for name in ("first", "second", "third")]
print(f"trimesh:   alphas {alphas}, modes {modes}")
sys.exit(0 if len(set(opacities)) == 1 and not told and len(set(alphas)) == 1 else 1)
PYTHON
