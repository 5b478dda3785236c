"""Triangle meshes from files."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path

from ibr_ref.io import bpt, obj, ply, stl
from ibr_ref.io.bezier import tessellate
from ibr_ref.io.files import contents, naming
from ibr_ref.scene import Mesh, checks

_MOST_QUADS = 256

_DECODERS: dict[str, Callable[[bytes, Path, int], Mesh]] = {
    ".obj": lambda data, path, quads: obj.decode(data),
    ".ply": lambda data, path, quads: ply.decode(data),
    ".stl": lambda data, path, quads: stl.decode(data),
    ".glb": lambda data, path, quads: _from_gltf(data, path),
    ".gltf": lambda data, path, quads: _from_gltf(data, path),
    ".bpt": lambda data, path, quads: _from_patches(data, quads),
}


def read_mesh(path: str | PathLike[str], quads: int = 6) -> Mesh:
    """Read a mesh, told by its ending: .obj, .ply, .stl, .glb, .gltf, .bpt.

    Vertices and triangles are those of the file, in its order, nothing merged: an STL has three vertices a triangle.
    Polygons, strips and fans are cut into triangles, concave polygons too; the parts of a glTF scene are put in their places
    and joined. Vertex colours are kept (of 8 and 16 bits, or floats in [0, 1]); materials, textures and the colours of
    faces are not read.

    Bicubic Bézier patches (.bpt, both dialects: `ibr_ref.io.bpt`) are cut into quads x quads pieces of two triangles each,
    1 to 256; with 6 the 32 patches of Newell's teapot are the 1,152 polygons of Kang & Ihm's. Other files ignore `quads`.

    Raises OSError or ValueError, in one line that starts with the path, for what cannot be read, is no such file, is
    not all there or more than it says, would be another mesh if it were read (points and lines, required extensions, skins,
    polygons that cross themselves), or is no `Mesh`: no triangles, vertices that are not finite, corners that do not exist.
    """
    quads = checks.whole("quads", quads, low=1, high=_MOST_QUADS)
    data = contents(path)
    ending = Path(path).suffix.lower()
    with naming(path):
        if ending not in _DECODERS:
            raise ValueError(f"found the ending {ending!r}, allowed: {', '.join(_DECODERS)}")
        return _DECODERS[ending](data, Path(path), quads)


def _from_gltf(data: bytes, path: Path) -> Mesh:
    from ibr_ref.io import gltf  # here: pydantic takes a quarter of a second

    return gltf.decode(data, path)


def _from_patches(data: bytes, quads: int) -> Mesh:
    vertices, triangles = tessellate(bpt.decode(data), quads)
    return Mesh(vertices=vertices, triangles=triangles)
