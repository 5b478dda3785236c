"""Triangle meshes from files: Wavefront OBJ and Bézier patches here, PLY, STL and glTF through trimesh."""

from __future__ import annotations

import logging
import re
import struct
import warnings
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ibr_ref.io import bpt, obj
from ibr_ref.io.bezier import tessellate
from ibr_ref.io.files import contents, naming
from ibr_ref.scene import Mesh, checks

_BINARY_STL_HEADER, _BINARY_STL_TRIANGLE = 84, 50
"""Bytes."""
_TRIMESH_OPTIONS: dict[str, dict[str, bool]] = {
    ".ply": {"fix_texture": False, "skip_materials": True},  # else vertices with two texture coordinates are split
    ".stl": {},
    ".glb": {"skip_materials": True},
    ".gltf": {"skip_materials": True},
}

_MOST_QUADS = 256

_SILENT = logging.NullHandler()
"""Without a handler, trimesh's warnings would go to standard error, beside the one line that says what is wrong."""


def read_mesh(path: str | PathLike[str], quads: int = 6) -> Mesh:
    """Read a mesh, told by its ending: .obj, .ply, .stl, .glb, .gltf, .bpt.

    Vertices and triangles are those of the file, in its order, nothing merged: an STL has three vertices a triangle.
    Polygons are cut into triangles, the parts of a glTF scene put in their places and joined. Vertex colours are kept
    (8 bits each, but for OBJ: as written); materials and textures are not read.

    Bicubic Bézier patches (.bpt, both dialects: `ibr_ref.io.bpt`) are cut into quads x quads pieces of two triangles each,
    1 to 256; with 6 the 32 patches of Newell's teapot are the 1,152 polygons of Kang & Ihm's. Other files ignore `quads`.

    Raises OSError or ValueError, in one line that starts with the path, for what cannot be read, is no such file, is
    not all there, or is no `Mesh`: no triangles, vertices that are not finite, corners that do not exist.
    """
    quads = checks.whole("quads", quads, low=1, high=_MOST_QUADS)
    data = contents(path)
    ending = Path(path).suffix.lower()
    with naming(path):
        if ending == ".obj":
            return _from_obj(data)
        if ending == ".bpt":
            return _from_patches(data, quads)
        if ending in _TRIMESH_OPTIONS:
            return _from_trimesh(data, ending, path)
        raise ValueError(f"found the ending {ending!r}, allowed: .obj, {', '.join(_TRIMESH_OPTIONS)}, .bpt")


def _from_obj(data: bytes) -> Mesh:
    polygons = obj.decode(data)
    fields: dict[str, Any] = {"color": polygons.colors} if polygons.colors else {}
    vertices, triangles = np.reshape(polygons.vertices, (-1, 3)), np.reshape(polygons.triangles, (-1, 3))
    return Mesh(vertices=vertices, triangles=triangles.astype(np.int64), **fields)


def _from_patches(data: bytes, quads: int) -> Mesh:
    vertices, triangles = tessellate(bpt.decode(data), quads)
    return Mesh(vertices=vertices, triangles=triangles)


def _from_trimesh(data: bytes, ending: str, path: str | PathLike[str]) -> Mesh:
    import trimesh  # here: half a second

    logging.getLogger("trimesh").addHandler(_SILENT)
    _check_whole(data, ending)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # NumPy's word for a number that it cannot read; the rest of the text would be left out.
        warnings.filterwarnings("error", message="string or file could not be read")
        loaded: Any = trimesh.load(
            BytesIO(data),
            file_type=ending[1:],
            resolver=trimesh.resolvers.FilePathResolver(str(path)),  # a .gltf has its numbers in files beside it
            process=False,
            force="mesh",
            **_TRIMESH_OPTIONS[ending],
        )
    fields = {"color": loaded.visual.vertex_colors[:, :3] / 255.0} if loaded.visual.kind == "vertex" else {}
    return Mesh(vertices=loaded.vertices, triangles=loaded.faces, **fields)


def _check_whole(data: bytes, ending: str) -> None:
    """Check the two formats whose text trimesh reads as far as it goes."""
    if ending == ".stl":
        _check_stl(data)
    elif ending == ".ply":
        _check_ply(data)


def _check_stl(data: bytes) -> None:
    if data[:5].lower() == b"solid" and b"endsolid" in data.lower():
        return
    count = struct.unpack_from("<I", data, _BINARY_STL_HEADER - 4)[0] if len(data) >= _BINARY_STL_HEADER else 0
    needed = _BINARY_STL_HEADER + _BINARY_STL_TRIANGLE * count
    if len(data) != needed:
        raise ValueError(
            f"found {len(data)} bytes, allowed: a text from `solid` to `endsolid`, or binary STL: "
            f"{needed} bytes for the {count} triangles in its header"
        )


def _check_ply(data: bytes) -> None:
    header, end, body = data.partition(b"end_header")
    if not data.startswith(b"ply") or not end:
        raise ValueError("found no PLY header, allowed: a file from `ply` to `end_header` and its data")
    needed = sum(int(count) for count in re.findall(rb"^element\s+\S+\s+(\d+)", header, re.MULTILINE))
    if re.search(rb"^format\s+ascii", header, re.MULTILINE) and len(body.split(b"\n", 1)[-1].splitlines()) < needed:
        raise ValueError(f"found {len(body.splitlines()) - 1} lines of PLY data, {needed} needed by its header")
