"""A glTF document that grows accessor by accessor."""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

LETTER = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
Rows = list[tuple[float, ...]]


class Document:
    """Its tree, which tests may change, and its one buffer."""

    def __init__(self) -> None:
        self.data = b""
        self.tree: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": []}],
            "accessors": [],
            "bufferViews": [],
            "buffers": [{}],
        }

    def view(self, data: bytes, **more: Any) -> int:
        """A buffer view of its own."""
        self.data += bytes(-len(self.data) % 4)
        self.tree["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more})
        self.data += data
        return len(self.tree["bufferViews"]) - 1

    def accessor(self, rows: Rows, kind: int, stride: int | None = None, **more: Any) -> int:
        """Rows of numbers, `stride` bytes apart."""
        size = struct.calcsize(f"<{len(rows[0])}{LETTER[kind]}")
        gap = bytes([0xAB]) * ((stride or size) - size)
        data = gap.join(packed(rows[k : k + 1], kind) for k in range(len(rows)))
        view = self.view(data, **({"byteStride": stride} if stride else {}))
        return self.described(len(rows), len(rows[0]), kind, bufferView=view, **more)

    def described(self, count: int, width: int, kind: int, **more: Any) -> int:
        """An accessor without bytes of its own."""
        self.tree["accessors"].append({"componentType": kind, "count": count, "type": TYPES[width], **more})
        return len(self.tree["accessors"]) - 1

    def indices(self, corners: list[int], kind: int = 5123) -> int:
        return self.accessor([(corner,) for corner in corners], kind)

    def primitive(self, position: int, indices: int | None = None, color: int | None = None, **more: Any) -> Document:
        """One more primitive of the first mesh."""
        attributes = {"POSITION": position, **({} if color is None else {"COLOR_0": color})}
        part = {"attributes": attributes, **({} if indices is None else {"indices": indices}), **more}
        self.tree["meshes"][0]["primitives"].append(part)
        return self

    def gltf(self, uri: str | None = None) -> bytes:
        """As text, with the numbers in it, or beside it under a name."""
        inside = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        self.tree["buffers"] = [{"byteLength": len(self.data), "uri": inside if uri is None else uri}]
        return json.dumps(self.tree).encode()

    def glb(self, *more: tuple[bytes, bytes]) -> bytes:
        """As a .glb, with further chunks."""
        self.tree["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.tree).encode()
        chunks = [(b"JSON", text + b" " * (-len(text) % 4)), (b"BIN\0", self.data + bytes(-len(self.data) % 4)), *more]
        body = b"".join(struct.pack("<I", len(data)) + name + data for name, data in chunks)
        return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


def packed(rows: Rows, kind: int) -> bytes:
    return b"".join(struct.pack(f"<{len(row)}{LETTER[kind]}", *row) for row in rows)
