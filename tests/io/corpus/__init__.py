"""Mesh files made by formula, each with what is to become of it."""

from __future__ import annotations

from tests.io.corpus import gltf_files, obj_files, ply_files, stl_files
from tests.io.corpus.item import Item

__all__ = ["Item", "items"]


def items() -> list[Item]:
    """All of them; the names are unique."""
    found = [*obj_files.items(), *ply_files.items(), *stl_files.items(), *gltf_files.items()]
    assert len({item.name for item in found}) == len(found)
    return found
