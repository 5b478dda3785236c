"""PLY: every format, type of number, type of list, kind of polygon, colour, order of properties, and what stands beside."""

from __future__ import annotations

import itertools
import struct
from typing import Any

from tests.io.corpus.item import Item
from tests.io.corpus.polygons import CROSSING, shapes

LETTER = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}
LETTER |= {"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I"}
LETTER |= {"float32": "f", "float64": "d"}
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}

POINTS = [(x, y, (x * y) % 3) for x in range(4) for y in range(3)]
TRIANGLES = [(0, 1, 3), (4, 3, 1), (5, 4, 2)]
FACES = {
    "triangles": TRIANGLES,
    "quads": [(0, 1, 4, 3), (3, 4, 7, 6)],
    "mixed": [(0, 1, 3), (3, 4, 7, 6), (0, 1, 2, 5, 8, 7, 4, 3), (2, 1, 0)],
    "mixed-first": [(3, 4, 7, 6), (0, 1, 3), (4, 3, 1)],
}
XYZ = [("float", axis) for axis in "xyz"]
CORNERS = [("list uchar int", "vertex_indices")]

Properties = list[tuple[str, str]]
Element = tuple[str, Properties, list[tuple[Any, ...]]]


def ply(form: str, elements: list[Element], ending: str = "\n", remark: str = "comment by formula") -> bytes:
    """A file with rows of numbers, and of tuples where a property is a list."""
    head, body, order = ["ply", f"format {form} 1.0", remark], b"", ORDERS[form]
    for name, properties, rows in elements:
        head.append(f"element {name} {len(rows)}")
        head += [f"property {kind} {title}" for kind, title in properties]
        for row in rows:
            words: list[str] = []
            for (kind, _), value in zip(properties, row, strict=True):
                types = kind.split()[1:] or [kind]
                values = [len(value), *value] if len(types) == 2 else [value]
                for k, number in enumerate(values):
                    letter = LETTER[types[min(k, len(types) - 1)]]
                    words.append(repr(number))
                    body += struct.pack(order + letter, number) if order else b""
            body += b"" if order else (" ".join(words) + ending).encode()
    return ("".join(line + ending for line in [*head, "end_header"])).encode() + body


def mesh(form: str, faces: list[tuple[int, ...]] = TRIANGLES, corners: str = "list uchar int", **kinds: str) -> bytes:
    """Points and faces, with a type each."""
    point = kinds.get("point", "float")
    vertex: Element = ("vertex", [(point, axis) for axis in "xyz"], list(POINTS))
    return ply(form, [vertex, ("face", [(corners, kinds.get("name", "vertex_indices"))], [(face,) for face in faces])])


def _types(form: str) -> list[Item]:
    found = []
    for kind in LETTER:
        found.append(Item(f"{form}-point-{kind}.ply", mesh(form, point=kind)))
        refusal = "list of whole numbers" if kind[0] in "fd" else None
        found.append(Item(f"{form}-corner-{kind}.ply", mesh(form, FACES["mixed"], f"list uchar {kind}"), refusal))
        refusal = "property [list TYPE]" if kind[0] in "fd" else None
        if kind[0] not in "fd" or form == "ascii":
            data = mesh(form, FACES["mixed"], f"list {kind} ushort")
            found.append(Item(f"{form}-length-{kind}.ply", data, refusal))
    for name, faces in FACES.items():
        found.append(Item(f"{form}-{name}.ply", mesh(form, faces)))
    return found


def _colors(form: str) -> list[Item]:
    found = []
    for kind, largest in (
        ("uchar", 255),
        ("uint16", 65535),
        ("float", 1.0),
        ("float64", 1.0),
        ("int", 255),
        ("char", 127),
    ):
        names = ("red", "green", "blue", "alpha")
        shades = [[type(largest)(largest * ((k * n) % 5) / 4) for n in (1, 2, 3, 4)] for k in range(len(POINTS))]
        rows = [(shade[0], *point, *shade[1:]) for shade, point in zip(shades, POINTS, strict=True)]
        properties = [(kind, "red"), *XYZ, *[(kind, name) for name in names[1:]]]
        faces: Element = ("face", CORNERS, [(face,) for face in FACES["mixed"]])
        refusal = "the type of red" if kind in ("int", "char") else None
        found.append(Item(f"{form}-colour-{kind}.ply", ply(form, [("vertex", properties, rows), faces]), refusal))
        without = [p for p in properties if p[1] != "blue"]
        rows = [(*row[:5], row[6]) for row in rows]
        found.append(Item(f"{form}-no-blue-{kind}.ply", ply(form, [("vertex", without, rows), faces]), "blue"))
    return found


def _beside(form: str) -> list[Item]:
    edges: Element = ("edge", [("int", "vertex1"), ("int", "vertex2")], [(0, 1), (1, 2)])
    notes: Element = ("note", [("list uchar double", "x"), ("short", "y"), ("list int char", "z")],
                      [((1.5, 2.5), 7, ()), ((), -8, (1, 2, 3))])  # fmt: skip
    vertex: Element = ("vertex", [("double", "z"), ("list uchar float", "more"), ("double", "y"), ("double", "x")],
                       [(z, (x,) * (k % 3), y, x) for k, (x, y, z) in enumerate(POINTS)])  # fmt: skip
    faces: Element = ("face", [("uchar", "red"), *CORNERS, ("list uchar float", "texcoord"), ("float", "quality")],
                      [(k, face, (0.5,) * k, 0.25) for k, face in enumerate(FACES["mixed"])])  # fmt: skip
    strips: Element = ("tristrips", [("list int int", "vertex_indices")], [((0, 1, 3, 4, 6, -1, 2, 1, 5, -1, -1),)])
    orders = [[edges, vertex, faces, notes], [notes, faces, edges, vertex], [vertex, strips], [vertex, faces, strips]]
    found = [Item(f"{form}-order-{k}.ply", ply(form, elements)) for k, elements in enumerate(orders)]
    bad: Element = ("tristrips", [("list int int", "vertex_indices")], [((0, 1, -1, 4, 6, 2),)])
    found.append(Item(f"{form}-short-strip.ply", ply(form, [vertex, bad]), "a strip of 2"))
    for ending, remark in itertools.product(("\n", "\r\n", "\r"), ("comment end_header", "obj_info")):
        name = f"{form}-ending-{len(ending)}{ord(ending[0])}-{len(remark)}.ply"
        found.append(Item(name, ply(form, [vertex, faces, edges], ending, remark)))
    return found


def _wrong(form: str) -> list[Item]:
    whole = mesh(form, FACES["mixed"])
    changes = [
        ("element vertex 12", "element vertex 11", ""), ("element vertex 12", "element vertex 13", ""),
        ("element vertex 12", "element vertex 99999999999", "needed"), ("element face 4", "element face 3", "header"),
        ("element face 4", "element face 5", ""), ("element face 4", "element face 2147483647", "needed"),
        ("element vertex 12", "element vertex -1", "line 4"), ("element vertex 12", "element vertex 1_2", "line 4"),
        ("element face", "element vertex", "line 8"), ("property float y", "property float x", "line 6"),
        ("property float y", "property half y", "line 6"), ("property float z\n", "", ""), ("1.0\n", "2.0\n", "line 2"),
        (" vertex_indices", " corners", "one list"), ("element face", "element faces", "T >= 1"),
        ("end_header\n", "", "PLY header"),
        ("element face", f"element {'x' * 65}", "line 8"), ("element face", f"element {'x' * 64}", "T >= 1"),
        ("property float y", f"property float {'y' * 65}", "line 6"),
    ]  # fmt: skip
    found = []
    for k, (old, new, words) in enumerate(changes):
        changed = whole.replace(old.encode(), new.encode(), 1)
        assert changed != whole
        found.append(Item(f"{form}-wrong-{k}.ply", changed, words))
    for k, face in enumerate([(0, 1, 12), (0, 1, -1), (0, 1), (), (0, 1, 2, 2**30)]):
        found.append(Item(f"{form}-wrong-face-{k}.ply", mesh(form, [(0, 1, 3), face]), "found"))
    found.append(Item(f"{form}-more.ply", whole + b"7 ", "found"))
    infinite = ply(form, [("vertex", [("double", axis) for axis in "xyz"], [(0.0, float("inf"), 1.0)] * 3),
                          ("face", CORNERS, [((0, 1, 2),)])])  # fmt: skip
    found.append(Item(f"{form}-infinite.ply", infinite, "finite"))
    return found


def items() -> list[Item]:
    found = [item for form in ORDERS for part in (_types, _colors, _beside, _wrong) for item in part(form)]
    for name, corners in shapes().items():
        points: Element = ("vertex", [("double", axis) for axis in "xyz"], corners)
        faces: Element = ("face", CORNERS, [((0, 1, 2),), (tuple(range(len(corners))),)])
        found.append(Item(f"polygon-{name}.ply", ply("binary_big_endian", [points, faces])))
    for name, flat in CROSSING.items():
        points = ("vertex", [("double", axis) for axis in "xyz"], [(x, y, 1.0) for x, y in flat])
        faces = ("face", CORNERS, [(tuple(range(len(flat))),)])
        found.append(Item(f"crossing-{name}.ply", ply("ascii", [points, faces]), "crosses itself"))
    wide = mesh("ascii").replace(b"\n0 0 0\n", b"\n1e39 0 0\n", 1)
    found.append(Item("float-too-large.ply", wide, "finite"))
    found.append(
        Item("uchar-too-large.ply", mesh("ascii", point="uchar").replace(b"\n0 0 0\n", b"\n256 0 0\n", 1), "256")
    )
    found.append(Item("underscored.ply", mesh("ascii").replace(b"\n0 0 0\n", b"\n1_0 0 0\n", 1), "1_0"))
    return found
