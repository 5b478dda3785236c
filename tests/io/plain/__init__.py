"""Mesh files read once more: plain Python from the formats' specifications, sharing nothing with the package.

A reader gives the polygons of a file as lists of corners (x, y, z, r, g, b), in the file's order, uncut; or `Refused`.
"""

from __future__ import annotations

import struct
from pathlib import Path

from tests.io.plain.surface import NO_COLOR, Refused, Surface

__all__ = ["NO_COLOR", "Refused", "Surface", "read"]


def read(path: Path) -> Surface:
    from tests.io.plain import gltf, obj, ply, stl

    data = path.read_bytes()
    kind = path.suffix[1:].lower()
    try:
        surface = {
            "obj": obj.read,
            "ply": ply.read,
            "stl": stl.read,
            "glb": lambda d: gltf.read(d, path),
            "gltf": lambda d: gltf.read(d, path),
        }[kind](data)
    except (IndexError, KeyError, TypeError, ValueError, OverflowError, AttributeError, OSError, struct.error) as error:
        raise Refused(f"{type(error).__name__} {error}") from error
    if not surface:
        raise Refused("no polygons")
    return surface
