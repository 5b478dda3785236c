"""The scene of a glTF document as one mesh."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ibr_ref.array_types import Floats, Ints
from ibr_ref.io.gltf.accessors import Accessors
from ibr_ref.io.gltf.buffers import Buffers, split
from ibr_ref.io.gltf.document import Document, Node, Primitive, decode_document, member, refused
from ibr_ref.io.gltf.placement import is_mirrored, moved, placement
from ibr_ref.io.polygons import check_corners, fan, strip
from ibr_ref.scene import Mesh

_TRIANGLES, _STRIP = 4, 5
_MODES = ("points", "lines", "a line loop", "a line strip", "triangles", "a triangle strip", "a triangle fan")
_MOST = 2**27
"""Vertices, or corners of triangles, of all parts: a file that shows one mesh many times is small."""
_UNREAD = ("EXT_mesh_gpu_instancing", "KHR_node_visibility")
"""Extensions of nodes that show other triangles, or none."""


class _Vertices(NamedTuple):
    """Vertices that the primitives of a mesh share."""

    positions: Floats
    colors: Floats | None


class _Part(NamedTuple):
    """The vertices of a node, placed, and all triangles between them."""

    positions: Floats
    colors: Floats | None
    triangles: Ints


def decode(data: bytes, path: Path) -> Mesh:
    """Read a .gltf or .glb, told by its first bytes; `path` says where the files beside it are.

    The scene that is shown (else the first, else all root nodes), node by node; vertices in the order of the file, those
    that primitives share not repeated. Triangles of mirroring nodes are turned round, as glTF asks. Where some vertices
    have colours, others have the colour that a Mesh has without any.

    Raises ValueError, with the field, for what glTF does not allow, and what is not read: points and lines, skins,
    weights of morph targets, extensions that change triangles.
    """
    text, binary = split(data)
    document = decode_document(text)
    accessors = Accessors(document, Buffers(document, binary, path))
    parts: list[_Part] = []
    left = _MOST
    for index, matrix in _placed(document):
        for part in _shown(document, accessors, index, matrix):
            left -= max(len(part.positions), part.triangles.size)
            if left < 0:
                raise refused("nodes", f"more than {_MOST} vertices in all", f"up to {_MOST}")
            parts.append(part)
    return _joined(parts)


def _joined(parts: list[_Part]) -> Mesh:
    if not parts:
        raise ValueError("found no mesh in the scene, allowed: a scene with triangles")
    starts = np.cumsum([0] + [len(part.positions) for part in parts])
    triangles = [part.triangles + start for part, start in zip(parts, starts, strict=False)]
    fields: dict[str, Any] = {}
    if any(part.colors is not None for part in parts):
        colors = [np.full(p.positions.shape, Mesh.color) if p.colors is None else p.colors for p in parts]
        fields["color"] = np.concatenate(colors)
    vertices = np.concatenate([part.positions for part in parts])
    return Mesh(vertices=vertices, triangles=np.concatenate(triangles), **fields)


def _placed(document: Document) -> Iterator[tuple[int, Floats]]:
    """Yield the nodes of the scene and their places in the world, children after their parents."""
    nodes = document.nodes
    if document.scenes:
        roots = member(document.scenes, document.scene or 0, "scenes").nodes
    else:
        children = {child for node in nodes for child in node.children}
        roots = [index for index in range(len(nodes)) if index not in children]
    waiting = [(index, np.eye(4)) for index in reversed(roots)]
    seen: set[int] = set()
    while waiting:
        index, parent = waiting.pop()
        if index in seen:
            raise refused(f"nodes.{index}", "two parents, or itself among its parents", "one parent, or none")
        seen.add(index)
        node = member(nodes, index, "nodes")
        matrix = placement(node, f"nodes.{index}", parent)
        yield index, matrix
        waiting.extend((child, matrix) for child in reversed(node.children))


def _shown(document: Document, accessors: Accessors, index: int, matrix: Floats) -> Iterator[_Part]:
    """Yield what one node shows, for each set of vertices one part."""
    node = member(document.nodes, index, "nodes")
    for name in _UNREAD:
        if name in node.extensions:
            raise refused(f"nodes.{index}", name, "nodes without it")
    if node.mesh is None:
        return
    mesh = member(document.meshes, node.mesh, "meshes")
    _check_rest(node, index, mesh.weights)
    shared: dict[tuple[int | None, int | None], list[Ints]] = {}
    for k, primitive in enumerate(mesh.primitives):
        name = f"meshes.{node.mesh}.primitives.{k}"
        count = _check_primitive(accessors, primitive, name)
        key = (primitive.attributes["POSITION"], primitive.attributes.get("COLOR_0"))
        shared.setdefault(key, []).append(_triangles(accessors, primitive, name, count))
    for (position, color), triangles in shared.items():
        assert position is not None
        corners = np.concatenate(triangles)
        yield _Part(
            moved(accessors.numbers(position), matrix),
            None if color is None else accessors.numbers(color)[:, :3],
            corners[:, ::-1] if is_mirrored(matrix) else corners,
        )


def _check_rest(node: Node, index: int, weights: list[float]) -> None:
    if node.skin is not None:
        raise refused(f"nodes.{index}.skin", node.skin, "meshes without a skin")
    used = [weight for weight in node.weights or weights if weight]
    if used:
        raise refused(f"nodes.{index}.weights", used[0], "morph targets of weight 0")


def _check_primitive(accessors: Accessors, primitive: Primitive, name: str) -> int:
    """The number of vertices. Raises ValueError for what cannot be read as triangles with colours."""
    if primitive.mode < _TRIANGLES:
        raise refused(f"{name}.mode", f"{primitive.mode}, {_MODES[primitive.mode]}", "4 to 6, triangles")
    if "POSITION" not in primitive.attributes:
        raise refused(f"{name}.attributes", "no POSITION", "vertices with positions")
    described = {key: accessors.described(index) for key, index in primitive.attributes.items()}
    position, color = described["POSITION"], described.get("COLOR_0")
    if "KHR_draco_mesh_compression" in primitive.extensions and position.bufferView is None:
        raise refused(f"{name}.extensions", "KHR_draco_mesh_compression", "vertices as they are")
    if position.type != "VEC3" or position.componentType == 5125:
        kind = f"{position.type} {position.componentType}"
        raise refused(f"{name}.attributes.POSITION", kind, "VEC3 of 32-bit floats, or of 8 or 16 bits")
    for key, accessor in described.items():
        if accessor.count != position.count:
            raise refused(f"{name}.attributes.{key}", f"{accessor.count} elements", f"{position.count}, as POSITION")
    if color is not None:
        kind = f"{color.type} {color.componentType}{' normalized' if color.normalized else ''}"
        if color.type not in ("VEC3", "VEC4") or (color.componentType, color.normalized) not in (
            (5126, False),
            (5121, True),
            (5123, True),
        ):
            allowed = "VEC3 or VEC4, floats (5126) or normalized 5121 or 5123"
            raise refused(f"{name}.attributes.COLOR_0", kind, allowed)
    return position.count


def _triangles(accessors: Accessors, primitive: Primitive, name: str, count: int) -> Ints:
    """(T, 3) corners of one primitive."""
    if primitive.indices is None:
        if count > _MOST:
            raise refused(name, f"{count} vertices", f"up to {_MOST}")
        corners = np.arange(count)
    else:
        corners = accessors.indices(primitive.indices)
        check_corners(corners, count)
    if len(corners) < 3 or (primitive.mode == _TRIANGLES and len(corners) % 3):
        allowed = "3, 6, 9 ..." if primitive.mode == _TRIANGLES else "3 or more"
        raise refused(name, f"{len(corners)} corners", allowed)
    if primitive.mode == _TRIANGLES:
        return corners.reshape(-1, 3)
    return strip(corners) if primitive.mode == _STRIP else fan(corners)
