"""PLY."""

from __future__ import annotations

import struct
from typing import Any

from tests.io.plain.surface import Refused, Surface, assembled, need, number, whole

_LETTER = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}
_LETTER |= {"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I"}
_LETTER |= {"float32": "f", "float64": "d"}
_LARGEST = {"B": 255, "H": 65535, "f": 1, "d": 1}


class _Text:
    def __init__(self, data: bytes) -> None:
        self.lines = [line.split() for line in data.replace(b"\r", b"\n").split(b"\n")]
        self.lines = [line for line in self.lines if line]
        self.row: list[bytes] = []

    def begin(self) -> None:
        self.row = self.lines.pop(0)

    def value(self, letter: str) -> Any:
        word = self.row.pop(0)
        if letter in "fd":
            value = number(word)
            try:
                return struct.unpack(letter, struct.pack(letter, value))[0]
            except OverflowError:
                raise Refused("too large") from None
        try:
            struct.pack(letter, whole(word))
        except struct.error:
            raise Refused("out of range") from None
        return whole(word)

    def end(self) -> None:
        need(not self.row, "more words")

    def finish(self) -> None:
        need(not self.lines, "more lines")


class _Binary:
    def __init__(self, data: bytes, order: str) -> None:
        self.data, self.order, self.place = data, order, 0

    def begin(self) -> None:
        pass

    end = begin

    def value(self, letter: str) -> Any:
        size = struct.calcsize("=" + letter)
        need(self.place + size <= len(self.data), "too few bytes")
        (value,) = struct.unpack_from(self.order + letter, self.data, self.place)
        self.place += size
        return value

    def finish(self) -> None:
        need(not self.data[self.place :].strip(), "more bytes")


def read(data: bytes) -> Surface:
    first = min((data.find(c) for c in (b"\n", b"\r") if c in data), default=0)
    need(data[:first].rstrip(b" \t") == b"ply", "ply")
    ending = b"\r\n" if data[first : first + 2] == b"\r\n" else data[first : first + 1]
    elements: list[tuple[str, int, list[tuple[str, str | None, str]]]] = []
    form, place = "", first + len(ending)
    while True:
        stop = data.find(ending, place)
        need(stop >= 0, "no end of the header")
        words = [word.decode("latin-1") for word in data[place:stop].split()]
        place = stop + len(ending)
        if not words or words[0] in ("comment", "obj_info"):
            continue
        if words == ["end_header"]:
            break
        if not form:
            need(words[0] == "format" and words[2:] == ["1.0"], "format")
            form = words[1]
        elif words[0] == "element":
            need(len(words) == 3 and words[1] not in [e[0] for e in elements])
            elements.append((words[1], whole(words[2].encode("latin-1")), []))
            need(elements[-1][1] >= 0)
        elif words[0] == "property" and words[1] == "list":
            need(len(words) == 5 and words[4] not in [p[2] for p in elements[-1][2]])
            elements[-1][2].append((_LETTER[words[3]], _LETTER[words[2]], words[4]))
            need(_LETTER[words[2]] not in "fd", "the type of a length")
        else:
            need(words[0] == "property" and len(words) == 3 and words[2] not in [p[2] for p in elements[-1][2]])
            elements[-1][2].append((_LETTER[words[1]], None, words[2]))
    source = _source(form, data[place:])
    tables = {
        name: [_row(source, properties) for _ in range(count)] for name, count, properties in _bounded(elements, data)
    }
    source.finish()
    return _surface(tables, {name: {p[2]: p for p in properties} for name, _, properties in elements})


def _bounded(elements: Any, data: bytes) -> Any:
    for name, count, properties in elements:
        need(properties and count <= len(data), "more rows than bytes")
        yield name, count, properties


def _source(form: str, body: bytes) -> Any:
    if form == "ascii":
        return _Text(body)
    return _Binary(body, {"binary_little_endian": "<", "binary_big_endian": ">"}[form])


def _row(source: Any, properties: list[tuple[str, str | None, str]]) -> dict[str, Any]:
    row = {}
    source.begin()
    for letter, length, name in properties:
        if length is None:
            row[name] = source.value(letter)
        else:
            count = source.value(length)
            need(count >= 0, "a negative length")
            row[name] = [source.value(letter) for _ in range(count)]
    source.end()
    return row


def _surface(tables: dict[str, list[dict[str, Any]]], types: dict[str, Any]) -> Surface:
    points = [tuple(float(v[axis]) for axis in "xyz") for v in tables["vertex"]]
    colors = None
    for prefix in ("", "diffuse_"):
        names = [prefix + name for name in ("red", "green", "blue")]
        if colors is None and any(name in types["vertex"] for name in names):
            letters = {types["vertex"][name][0] for name in names}
            need(len(letters) == 1 and not any(types["vertex"][name][1] for name in names))
            colors = [tuple(v[name] / _LARGEST[min(letters)] for name in names) for v in tables["vertex"]]
    polygons: list[list[int]] = []
    for element in ("face", "tristrips"):
        if element in tables:
            (name,) = [n for n in ("vertex_indices", "vertex_index") if n in types[element]]
            letter, length, _ = types[element][name]
            need(length and letter not in "fd", "corners")
            for row in tables[element]:
                polygons += [row[name]] if element == "face" else _strip(row[name])
    return assembled(points, colors, polygons)


def _strip(corners: list[int]) -> list[list[int]]:
    triangles, run = [], []
    for corner in [*corners, -1]:
        if corner != -1:
            run.append(corner)
            continue
        need(len(run) not in (1, 2), "a strip of no triangle")
        for k in range(len(run) - 2):
            a, b, c = run[k : k + 3]
            triangles.append([a, b, c] if k % 2 == 0 else [a, c, b])
        run = []
    return triangles
