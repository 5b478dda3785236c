"""NumPy files (.npy), read with nothing believed: no pickles, and no allocation before the sizes agree.

The one form that is written and read: booleans, integers or floats, little-endian, in C order.
"""

from __future__ import annotations

import ast
import hashlib
import math
import struct
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.files.problem import UnusableError

MAGIC = b"\x93NUMPY"
LONGEST_HEADER = 4096
"""Bytes of a header's text; ours have 118."""

_DTYPES = {np.dtype(code).str: np.dtype(code) for code in ("?", "i1", "u1", "<i2", "<u2", "<i4", "<u4", "<i8", "<u8",
                                                           "<f2", "<f4", "<f8")}  # fmt: skip
_ALLOWED = "booleans, integers or floats, little-endian: " + ", ".join(_DTYPES)

HASHED = (
    'SHA-256 of the line "DTYPE SHAPE\\n" in ASCII, then of the array\'s bytes, little-endian and in C order; DTYPE as in '
    'the .npy header ("<f8", "<i4", "|u1", "|b1"), SHAPE with commas ("480,640,3"); of a PNG its samples as "|u1"'
)


@dataclass(frozen=True)
class Header:
    """What a file says of itself, found to be so."""

    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    offset: int
    """Where the numbers begin."""


Accept = Callable[[Header], None]
"""Raises UnusableError for an array of another type or shape than is wanted, before it is read."""


def digest(array: NDArray[Any]) -> str:
    """The array's hash, as `HASHED` says."""
    little = little_endian(array)
    line = f"{little.dtype.str} {','.join(map(str, little.shape))}\n"
    result = hashlib.sha256(line.encode())
    result.update(little.reshape(-1).view(np.uint8).data)
    return result.hexdigest()


def little_endian(array: NDArray[Any]) -> NDArray[Any]:
    """The array as it is written: C order, little-endian, every NaN the same one (its sign differs between processors)."""
    result = np.ascontiguousarray(array, array.dtype.newbyteorder("<")).reshape(array.shape)
    if result.dtype.kind == "f" and (missing := np.isnan(result)).any():
        result = np.where(missing, result.dtype.type(np.nan), result)
    return result


def write_array(file: BinaryIO, array: NDArray[Any]) -> None:
    """Write the array; the same bytes every time."""
    np.lib.format.write_array(file, little_endian(array), version=(1, 0), allow_pickle=False)


def read_array(path: str | PathLike[str], accept: Accept, name: object = None) -> NDArray[Any]:
    """Read a file that `accept` has nothing against; `name` is what errors call it (None: the path)."""
    path = Path(path)
    name = path if name is None else name
    with path.open("rb") as file:
        return decode(file, path.stat().st_size, accept, name)


def decode_bytes(data: bytes, accept: Accept, name: object) -> NDArray[Any]:
    """The array of a file's bytes."""
    return decode(BytesIO(data), len(data), accept, name)


def decode(file: BinaryIO, size: int, accept: Accept, name: object) -> NDArray[Any]:
    """Read an array from a stream of `size` bytes."""
    header = _header(file, size, name)
    accept(header)
    needed = header.offset + math.prod(header.shape) * header.dtype.itemsize
    if size != needed:
        raise UnusableError(name, f"{size} bytes", f"{needed} bytes, which its header needs")
    try:
        data = bytearray(needed - header.offset)
    except MemoryError:
        raise UnusableError(name, f"{needed} bytes", "what fits in memory") from None
    if file.readinto(data) != len(data):  # type: ignore[attr-defined]
        raise UnusableError(name, "a file that is being cut off", "a file that nobody writes to")
    array: NDArray[Any] = np.frombuffer(data, header.dtype).reshape(header.shape)
    if header.dtype.kind == "b" and array.size and array.view(np.uint8).max() > 1:
        raise UnusableError(name, "booleans other than 0 and 1", "bytes 0 and 1")
    return array


def _header(file: BinaryIO, size: int, name: object) -> Header:
    start = file.read(8)
    if start[:1] == b"\x80":
        raise UnusableError(name, "a pickle", "a NumPy file (.npy); pickles are not read")
    if start[:6] != MAGIC or start[6:] not in (b"\x01\x00", b"\x02\x00", b"\x03\x00"):
        raise UnusableError(name, f"{size} bytes that start with {start!r}", "a NumPy file (.npy), version 1, 2 or 3")
    width = 2 if start[6] == 1 else 4
    count = file.read(width)
    length = struct.unpack("<H" if width == 2 else "<I", count)[0] if len(count) == width else size
    offset = 8 + width + length
    if length > LONGEST_HEADER or offset > size:
        raise UnusableError(
            name, f"{size} bytes and a header of {length}", f"a header of at most {LONGEST_HEADER}, whole"
        )
    return _parsed(file.read(length), offset, name)


def _parsed(text: bytes, offset: int, name: object) -> Header:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            fields = ast.literal_eval(text.decode("latin-1").strip())
    except (ValueError, SyntaxError, MemoryError, RecursionError, Warning):
        fields = None
    if not isinstance(fields, dict) or set(fields) != {"descr", "fortran_order", "shape"}:
        raise UnusableError(name, f"the header {text[:60]!r}", "a dictionary of descr, fortran_order and shape")
    descr, order, shape = fields["descr"], fields["fortran_order"], fields["shape"]
    if not isinstance(descr, str) or descr not in _DTYPES:
        raise UnusableError(name, f"the dtype {descr!r}", _ALLOWED)
    if not isinstance(shape, tuple) or len(shape) > 8 or not all(type(n) is int and 0 <= n < 2**40 for n in shape):
        raise UnusableError(name, f"the shape {shape!r}", "at most 8 whole numbers")
    if order is not False:
        raise UnusableError(name, "Fortran order" if order is True else f"fortran_order {order!r}", "C order")
    return Header(_DTYPES[descr], shape, offset)
