"""The data of a PLY file as columns. What the header claims is believed only as far as there are data for it."""

from __future__ import annotations

import re
import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.ply_header import Element, Header, Property
from ibr_ref.io.words import real, shown, whole

_LINE = re.compile(rb"\r\n|\n|\r")
_STRUCT = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}


class Lists(NamedTuple):
    """A list in each row, all one after the other."""

    counts: NDArray[np.int64]
    items: NDArray[np.generic]


Column = NDArray[np.generic] | Lists
Table = dict[str, Column]


def binary_tables(header: Header, body: bytes) -> dict[str, Table]:
    """The columns of each element. Raises ValueError for fewer or more bytes than the header says."""
    tables, place = {}, 0
    for element in header.elements:
        tables[element.name], place = _binary(element, header.order, body, place)
    if body[place:].strip():
        raise ValueError(f"found {len(body)} bytes of data, allowed: {place}, as its header says")
    return tables


def _binary(element: Element, order: str, body: bytes, place: int) -> tuple[Table, int]:
    """The table, and where the next begins. Rows are of one size, or read one by one."""
    needed = place + element.rows * sum(np.dtype(one.length or one.type).itemsize for one in element.properties)
    if needed > len(body):
        raise _too_few(element, len(body), needed)
    if not element.rows:
        return _by_rows(element, order, body, place)
    record = np.dtype(_record(element, order, body, place))
    if place + element.rows * record.itemsize <= len(body):
        rows = np.frombuffer(body, record, element.rows, place)
        lists = [one for one in element.properties if one.length]
        if all((rows[f"{one.name} count"] == rows[one.name].shape[1]).all() for one in lists):
            table: Table = {one.name: rows[one.name] for one in element.properties}
            for one in lists:
                table[one.name] = Lists(rows[f"{one.name} count"].astype(np.int64), rows[one.name].reshape(-1))
            return table, place + element.rows * record.itemsize
    return _by_rows(element, order, body, place)


def _record(element: Element, order: str, body: bytes, place: int) -> list[tuple[str, str, tuple[int, ...]]]:
    """The row at a place, with the lists as long as they are there."""
    fields: list[tuple[str, str, tuple[int, ...]]] = []
    for one in element.properties:
        if one.length:
            fields.append((f"{one.name} count", order + one.length, ()))
            (length,), place = _unpacked(element, order + _STRUCT[one.length], body, place)
            place += _list_bytes(element, one, length, len(body) - place)
            fields.append((one.name, order + one.type, (length,)))
        else:
            fields.append((one.name, order + one.type, ()))
            place += np.dtype(one.type).itemsize
    return fields


def _by_rows(element: Element, order: str, body: bytes, place: int) -> tuple[Table, int]:
    columns: dict[str, list[float]] = {one.name: [] for one in element.properties}
    counts: dict[str, list[int]] = {one.name: [] for one in element.properties if one.length}
    for _ in range(element.rows):
        for one in element.properties:
            length = 1
            if one.length:
                (length,), place = _unpacked(element, order + _STRUCT[one.length], body, place)
                _list_bytes(element, one, length, len(body) - place)
                counts[one.name].append(length)
            values, place = _unpacked(element, f"{order}{length}{_STRUCT[one.type]}", body, place)
            columns[one.name].extend(values)
    return _table(element, columns, counts), place


def _unpacked(element: Element, form: str, body: bytes, place: int) -> tuple[tuple[int, ...], int]:
    end = place + struct.calcsize(form)
    if end > len(body):
        raise _too_few(element, len(body), end)
    return struct.unpack_from(form, body, place), end


def _list_bytes(element: Element, one: Property, length: int, left: int) -> int:
    size = length * np.dtype(one.type).itemsize
    if not 0 <= size <= left:
        raise ValueError(
            f"found a list of {length} {one.name} in element {element.name}, allowed: what {left} bytes hold"
        )
    return size


def _too_few(element: Element, found: int, needed: int) -> ValueError:
    return ValueError(f"found {found} bytes of data, {needed} or more needed up to element {element.name}")


def text_tables(header: Header, body: bytes) -> dict[str, Table]:
    """The columns of each element, a line a row, blank lines skipped; ValueError for fewer or more lines, or words."""
    rows = [words for line in _LINE.split(body) if (words := line.split())]
    needed = sum(element.rows for element in header.elements)
    if len(rows) != needed:
        raise ValueError(f"found {len(rows)} lines of PLY data, {needed} needed by its header")
    tables, place = {}, 0
    for element in header.elements:
        tables[element.name] = _text(element, rows[place : place + element.rows])
        place += element.rows
    return tables


def _text(element: Element, rows: list[list[bytes]]) -> Table:
    columns: dict[str, list[float]] = {one.name: [] for one in element.properties}
    counts: dict[str, list[int]] = {one.name: [] for one in element.properties if one.length}
    for words in rows:
        place = 0
        try:
            for one in element.properties:
                length = 1
                if one.length:
                    length, place = int(_number(one.length, words[place])), place + 1
                    counts[one.name].append(length)
                if not 0 <= length <= len(words) - place:
                    raise ValueError
                columns[one.name].extend(_number(one.type, word) for word in words[place : place + length])
                place += length
            if place != len(words):
                raise ValueError
        except (ValueError, IndexError):
            allowed = " ".join(
                f"{one.name} ({'list of ' if one.length else ''}{one.type})" for one in element.properties
            )
            raise ValueError(f"found {shown(words)} in element {element.name}, allowed: {allowed[:160]}") from None
    return _table(element, columns, counts)


def _number(kind: str, word: bytes) -> float:
    """A number that the type can hold."""
    if kind[0] == "f":
        return real(word)
    number, limits = whole(word), np.iinfo(kind)
    if not limits.min <= number <= limits.max:
        raise ValueError
    return number


def _table(element: Element, columns: dict[str, list[float]], counts: dict[str, list[int]]) -> Table:
    table: Table = {}
    with np.errstate(over="ignore"):  # a float that is too large is infinite, and refused as such
        for one in element.properties:
            column = np.array(columns[one.name], np.float64 if one.type[0] == "f" else np.int64).astype(one.type)
            table[one.name] = Lists(np.array(counts[one.name], np.int64), column) if one.length else column
    return table
