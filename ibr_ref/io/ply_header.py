"""The header of a PLY file: which elements, how many, and of what types."""

from __future__ import annotations

import re
from typing import NamedTuple

from ibr_ref.io.words import shown, whole

_TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4"},
    **{"double": "f8", "float64": "f8"},
}
"""The names of the format's two generations, and NumPy's."""
_ORDERS = {b"ascii": "", b"binary_little_endian": "<", b"binary_big_endian": ">"}
_LONGEST = 2**16
"""Bytes of a header: that of a file of all that any program writes is some thousand."""
_LONGEST_NAME = 64
"""Bytes: errors show them."""


class Property(NamedTuple):
    """A number or a list of numbers in each row."""

    name: str
    type: str
    """NumPy's, without byte order."""
    length: str | None = None
    """The type of a list's length."""


class Element(NamedTuple):
    """A table."""

    name: str
    rows: int
    properties: list[Property]

    def property(self, name: str) -> Property:
        """One that there is."""
        return next(one for one in self.properties if one.name == name)


class Header(NamedTuple):
    """Elements in the order of their data."""

    order: str
    """`<`, `>`, or nothing for text."""
    elements: list[Element]

    @property
    def text(self) -> bool:
        """Whether the data are text."""
        return not self.order

    def element(self, name: str) -> Element:
        """One that there is."""
        return next(one for one in self.elements if one.name == name)


def decode_header(data: bytes) -> tuple[Header, bytes]:
    """The header, and the data after it. Lines end as the first one does.

    Raises ValueError, with the line, for what no PLY header has, and for names that come twice.
    """
    start = re.match(rb"ply[ \t]*(\r\n|\n|\r)", data)
    lines = data[:_LONGEST].split(start[1]) if start else []
    end = next((k for k, line in enumerate(lines) if line.split() == [b"end_header"]), 0)
    if not start or not end or end == len(lines) - 1:
        raise ValueError("found no PLY header, allowed: a file from `ply` to `end_header` and its data")
    order, elements = None, list[Element]()
    for number, line in enumerate(lines[1:end], 2):
        words = line.split()
        try:
            if not words or words[0] in (b"comment", b"obj_info"):
                continue
            if order is None:
                order = _order(words)
            elif words[0] == b"element":
                elements.append(_element(words, elements))
            else:
                if not elements:
                    raise ValueError("an element before its properties")
                elements[-1].properties.append(_property(words, elements[-1]))
        except ValueError as error:
            raise ValueError(f"found {shown(words)} in line {number}, allowed: {error}") from None
    for element in elements:
        if not element.properties:
            raise ValueError(f"found no property in element {element.name}, allowed: one or more")
    length = sum(len(line) + len(start[1]) for line in lines[: end + 1])
    return Header(order or "", elements), data[length:]


def _order(words: list[bytes]) -> str:
    if len(words) != 3 or words[0] != b"format" or words[1] not in _ORDERS or words[2] != b"1.0":
        raise ValueError(f"format {b' | '.join(_ORDERS).decode()} 1.0")
    return _ORDERS[words[1]]


def _element(words: list[bytes], before: list[Element]) -> Element:
    allowed = "element, a new name of up to 64 bytes and the number of rows"
    try:
        _, name, rows = words
        result = Element(name.decode("latin-1"), whole(rows), [])
    except ValueError:
        raise ValueError(allowed) from None
    if result.rows < 0 or len(name) > _LONGEST_NAME or result.name in [element.name for element in before]:
        raise ValueError(allowed)
    return result


def _property(words: list[bytes], element: Element) -> Property:
    """`property TYPE NAME` or `property list TYPE TYPE NAME`."""
    types = [_TYPES.get(word.decode("latin-1")) for word in words[1:-1]]
    name = words[-1].decode("latin-1")
    if words[0] == b"property" and len(name) <= _LONGEST_NAME and name not in [one.name for one in element.properties]:
        if len(types) == 1 and types[0]:
            return Property(name, types[0])
        if len(types) == 3 and words[1] == b"list" and types[1] and types[2] and types[1][0] != "f":
            return Property(name, types[2], types[1])
    raise ValueError(
        f"element, or property [list TYPE] TYPE and a new name, of types {' '.join(list(_TYPES)[:7])} double"
    )
