"""The geometries that a scene may consist of. Each names the vertex shader that draws it."""

from .quads import Quads
from .strips import Strips
from .triangles import ReversedTriangles, Triangles

Geometry = Quads | Strips | Triangles | ReversedTriangles
