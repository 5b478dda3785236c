"""glTF 2.0."""

from __future__ import annotations

import base64
import json
import math
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

from tests.io.plain.surface import NO_COLOR, Corner, Surface, need

_LETTER = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
_WIDTH = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


class _File:
    def __init__(self, tree: Any, binary: bytes | None, path: Path) -> None:
        self.tree, self.binary, self.path = tree, binary, path

    def part(self, name: str, index: int) -> Any:
        need(index >= 0)
        return self.tree[name][index]

    def buffer(self, index: int) -> bytes:
        buffer = self.part("buffers", index)
        uri = buffer.get("uri")
        if uri is None:
            need(index == 0 and self.binary is not None, "no bytes")
            data = self.binary
        elif uri.lower().startswith("data:"):
            head, body = uri.split(",", 1)
            if head.lower().endswith(";base64"):
                data = base64.b64decode(unquote(body), validate=True)
            else:
                data = unquote_to_bytes(body)
        else:
            name = unquote(uri)
            need(name and ":" not in name and "\\" not in name and "\0" not in name, "uri")
            need(name[0] != "/" and ".." not in name.split("/"), "uri")
            place = self.path.parent / name
            need(place.is_file(), "uri")
            data = place.read_bytes()
        need(data is not None and len(data) >= buffer["byteLength"] > 0, "short buffer")
        return data[: buffer["byteLength"]]

    def elements(self, view: int, offset: int, count: int, letter: str, width: int, strided: bool) -> list[Any]:
        place = self.part("bufferViews", view)
        begin = place.get("byteOffset", 0)
        data = self.buffer(place["buffer"])[begin : begin + place["byteLength"]]
        need(len(data) == place["byteLength"] and begin >= 0 and offset >= 0, "short view")
        step = place.get("byteStride") if strided else None
        form = f"<{width}{letter}"
        need(step is None or (step % 4 == 0 and 4 <= step <= 252), "stride")
        step = step or struct.calcsize(form)
        need(step >= struct.calcsize(form), "stride")
        need(count > 0 and offset + step * (count - 1) + struct.calcsize(form) <= len(data), "accessor")
        return [struct.unpack_from(form, data, offset + step * k) for k in range(count)]

    def accessor(self, index: int) -> list[Any]:
        accessor = self.part("accessors", index)
        letter, width, count = _LETTER[accessor["componentType"]], _WIDTH[accessor["type"]], accessor["count"]
        need(count > 0 and ("bufferView" in accessor or count <= 2**20), "count")
        if "bufferView" not in accessor:
            rows: list[Any] = [(0,) * width] * count
        else:
            rows = self.elements(accessor["bufferView"], accessor.get("byteOffset", 0), count, letter, width, True)
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            where, what = sparse["indices"], sparse["values"]
            kind = {5121: "B", 5123: "H", 5125: "I"}[where["componentType"]]
            places = self.elements(where["bufferView"], where.get("byteOffset", 0), sparse["count"], kind, 1, False)
            values = self.elements(what["bufferView"], what.get("byteOffset", 0), sparse["count"], letter, width, False)
            need(places == sorted(set(places)), "order")
            for (k,), value in zip(places, values, strict=True):
                rows[k] = value
        if not accessor.get("normalized", False):
            return rows
        largest = {"b": 127.0, "B": 255.0, "h": 32767.0, "H": 65535.0}[letter]
        return [tuple(max(x / largest, -1.0) for x in row) for row in rows]


def read(data: bytes, path: Path) -> Surface:
    text, binary = _split(data)
    if text[:3] == b"\xef\xbb\xbf":
        text = text[3:]
    # A field that is null is none.
    tree = json.loads(
        text.decode("utf-8"), object_pairs_hook=lambda pairs: {key: value for key, value in pairs if value is not None}
    )
    need(tree["asset"]["version"].startswith("2."), "version")
    need(tree["asset"].get("minVersion", "2.0") == "2.0", "version")
    for name in tree.get("extensionsRequired", []):
        harmless = name.startswith(("KHR_materials", "KHR_texture", "EXT_texture", "KHR_lights"))
        need(harmless or name == "KHR_mesh_quantization", name)
    file = _File(tree, binary, path)
    nodes = tree.get("nodes", [])
    if tree.get("scenes"):
        roots = file.part("scenes", tree.get("scene", 0)).get("nodes", [])
    else:
        below = {child for node in nodes for child in node.get("children", [])}
        roots = [k for k in range(len(nodes)) if k not in below]
    surface: Surface = []
    visited: list[int] = []

    def visit(index: int, parents: list[Any]) -> None:
        need(index not in visited, "not a tree")
        visited.append(index)
        node = file.part("nodes", index)
        need(not {"EXT_mesh_gpu_instancing", "KHR_node_visibility"} & set(node.get("extensions", {})))
        chain = [*parents, _local(node)]
        if "mesh" in node:
            _show(file, node, chain, surface)
        for child in node.get("children", []):
            visit(child, chain)

    for root in roots:
        visit(root, [])
    return surface


def _split(data: bytes) -> tuple[bytes, bytes | None]:
    if data[:4] != b"glTF":
        return data, None
    version, length = struct.unpack("<II", data[4:12])
    need(version == 2 and length == len(data), "header")
    chunks, place = [], 12
    while place < length:
        need(place + 8 <= length, "chunk")
        size = int.from_bytes(data[place : place + 4], "little")
        need(place + 8 + size <= length, "chunk")
        chunks.append((data[place + 4 : place + 8], data[place + 8 : place + 8 + size]))
        place += 8 + size
    need(chunks[0][0] == b"JSON", "chunk")
    return chunks[0][1], chunks[1][1] if len(chunks) > 1 and chunks[1][0] == b"BIN\0" else None


def _local(node: Any) -> list[list[float]]:
    """Three rows of the 3 x 4 matrix."""
    if "matrix" in node:
        m = node["matrix"]
        need(len(m) == 16 and not {"translation", "rotation", "scale"} & set(node), "matrix")
        need(max(abs(a - b) for a, b in zip(m[3::4], (0, 0, 0, 1), strict=True)) <= 1e-6, "affine")
        return [[float(m[row + 4 * column]) for column in range(4)] for row in range(3)]
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    length = math.sqrt(x * x + y * y + z * z + w * w)
    need(abs(length * length - 1.0) <= 1e-3, "quaternion")
    x, y, z, w = x / length, y / length, z / length, w / length
    columns = []
    for axis, scale in zip(((1, 0, 0), (0, 1, 0), (0, 0, 1)), node.get("scale", (1, 1, 1)), strict=True):
        # v + 2 q x (q x v + w v)
        first = [c + w * a for c, a in zip(_cross((x, y, z), axis), axis, strict=True)]
        second = _cross((x, y, z), first)
        columns.append([scale * (a + 2.0 * s) for a, s in zip(axis, second, strict=True)])
    t = node.get("translation", (0, 0, 0))
    need(len(t) == 3)
    return [[columns[0][r], columns[1][r], columns[2][r], float(t[r])] for r in range(3)]


def _cross(a: Any, b: Any) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _show(file: _File, node: Any, chain: list[Any], surface: Surface) -> None:
    mesh = file.part("meshes", node["mesh"])
    need("skin" not in node and not any(node.get("weights") or mesh.get("weights", [])), "not at rest")
    groups: dict[Any, Surface] = {}
    for primitive in mesh["primitives"]:
        names = primitive["attributes"]
        position = file.part("accessors", names["POSITION"])
        counts = {file.part("accessors", index)["count"] for index in names.values()}
        need(len(counts) == 1 and position["type"] == "VEC3" and position["componentType"] != 5125, "attributes")
        need("bufferView" in position or "KHR_draco_mesh_compression" not in primitive.get("extensions", {}))
        points = [_moved(point, chain) for point in file.accessor(names["POSITION"])]
        colors: list[Corner] = [NO_COLOR] * len(points)
        if "COLOR_0" in names:
            color = file.part("accessors", names["COLOR_0"])
            kind = (color["componentType"], color.get("normalized", False))
            need(kind in ((5126, False), (5121, True), (5123, True)) and color["type"] in ("VEC3", "VEC4"), "colour")
            colors = [row[:3] for row in file.accessor(names["COLOR_0"])]
        need(all(math.isfinite(v) for p in points for v in p), "not finite")
        need(all(0.0 <= v <= 1.0 for c in colors for v in c), "colour")
        corners = list(range(len(points)))
        if "indices" in primitive:
            described = file.part("accessors", primitive["indices"])
            largest = {5121: 255, 5123: 65535, 5125: 2**32 - 1}[described["componentType"]]
            need(described["type"] == "SCALAR" and not described.get("normalized", False), "indices")
            corners = [k for (k,) in file.accessor(primitive["indices"])]
            need(all(k < len(points) and k != largest for k in corners), "indices")
        mode = primitive.get("mode", 4)
        need(mode in (4, 5, 6) and len(corners) >= 3 and (mode != 4 or len(corners) % 3 == 0), "mode")
        triangles = []
        for k in range(0, len(corners) - 2, 3 if mode == 4 else 1):
            a, b, c = corners[k : k + 3]
            if mode == 5 and k % 2:
                b, c = c, b
            if mode == 6:
                a, b, c = corners[0], b, c
            triangles.append([a, b, c])
        if _mirrored(chain):
            triangles = [[a, c, b] for a, b, c in triangles]
        key = (names["POSITION"], names.get("COLOR_0"))
        groups.setdefault(key, []).extend([(*points[k], *colors[k]) for k in t] for t in triangles)
    for group in groups.values():
        surface.extend(group)


def _moved(point: Any, chain: list[Any]) -> tuple[float, ...]:
    for matrix in reversed(chain):
        point = [row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3] for row in matrix]
    return tuple(float(x) for x in point)


def _mirrored(chain: list[Any]) -> bool:
    sign = 1.0
    for a, b, c in chain:
        d = sum(p * q for p, q in zip(a[:3], _cross(b[:3], c[:3]), strict=True))
        sign *= (d > 0) - (d < 0)
    return sign < 0
