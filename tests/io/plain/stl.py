"""STL."""

from __future__ import annotations

import struct

from tests.io.plain.surface import Surface, assembled, need, number


def read(data: bytes) -> Surface:
    points = []
    if len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little"):
        for place in range(84, len(data), 50):
            values = struct.unpack("<12fH", data[place : place + 50])
            points += [values[3:6], values[6:9], values[9:12]]
    else:
        points = _text(data)
    return assembled(points, None, [[k, k + 1, k + 2] for k in range(0, len(points), 3)])


def _text(data: bytes) -> list[tuple[float, ...]]:
    lines = [line.split() for line in data.replace(b"\r", b"\n").split(b"\n")]
    lines = [line for line in lines if line]
    points, k = [], 0
    need(lines, "empty")
    while k < len(lines):
        need(lines[k][0].lower() == b"solid", "solid")
        k += 1
        while lines[k][0].lower() != b"endsolid":
            block = lines[k : k + 7]
            heads = [b" ".join(word.lower() for word in line[: 2 if n < 2 else 1]) for n, line in enumerate(block)]
            need(heads == [b"facet normal", b"outer loop", b"vertex", b"vertex", b"vertex", b"endloop", b"endfacet"])
            need([len(line) for line in block] == [5, 2, 4, 4, 4, 1, 1])
            points += [tuple(number(word) for word in line[1:]) for line in block[2:5]]
            k += 7
        k += 1
    return points
