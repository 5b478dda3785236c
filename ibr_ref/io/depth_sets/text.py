"""Numbers in the text files of depth sets."""

from __future__ import annotations

import re
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.io.files import contents, naming
from ibr_ref.io.words import real, shown
from ibr_ref.scene import checks
from ibr_ref.scene.rotations import normalized, rotation_of

MOST_BYTES = 2**25
"""Of a text: two hundred thousand poses."""
_UNIT = 1e-2
"""How far the length of a quaternion, as it is printed, may be off 1."""


def text(path: Path, most: int = MOST_BYTES) -> bytes:
    """A text file's bytes, without a byte order mark."""
    data = contents(path)
    if len(data) > most:
        raise ValueError(f"{checks.named(path)}: found {len(data)} bytes of text, allowed: up to {most}")
    return data.removeprefix(b"\xef\xbb\xbf")


def lines(path: Path, most: int = MOST_BYTES) -> Iterator[tuple[int, list[bytes]]]:
    """Number and words of the lines that have any; `#` begins a comment line."""
    for number, line in enumerate(BytesIO(text(path, most)), 1):
        words = line.split()
        if words and not words[0].startswith(b"#"):
            yield number, words


def numbers(words: list[bytes], where: str) -> list[float]:
    """Numbers, NaN and infinities too; `where` is what an error calls their place in the file."""
    try:
        return [real(word) for word in words]
    except ValueError:
        raise ValueError(f"{where}: found {shown(words)}, allowed: numbers") from None


def finite(words: list[bytes], count: int, where: str) -> list[float]:
    """So many finite numbers."""
    values = numbers(words, where)
    if len(values) != count or not np.isfinite(values).all():
        raise ValueError(f"{where}: found {shown(words)}, allowed: {count} finite numbers")
    return values


def all_numbers(path: Path) -> list[float]:
    """Every number of a file; commas and brackets between them count as spaces do."""
    with naming(path):
        words = [word for _, line in lines(path) for word in re.split(rb"[\s,;\[\]]+", b" ".join(line)) if word]
        return numbers(words, "the file")


def matrix_file(path: Path) -> Floats:
    """(4, 4), of a file of 16 numbers, of 12 (the last row is 0 0 0 1), or of 9 (3 x 3, intrinsics)."""
    values = all_numbers(path)
    if len(values) not in (9, 12, 16):
        raise ValueError(f"{checks.named(path)}: found {len(values)} numbers, allowed: a matrix of 16, 12 or 9")
    result = np.eye(4)
    size = 3 if len(values) == 9 else 4
    rows = np.reshape(values, (-1, size))
    result[: len(rows), :size] = rows
    return result


def pose_of(quaternion_xyzw: list[float], translation: list[float]) -> Floats:
    """(4, 4) of a quaternion, the scalar last, and a shift. Raises ValueError for one that is not of length 1."""
    x, y, z, w = quaternion_xyzw
    norm = float(np.sqrt(x * x + y * y + z * z + w * w))
    if not abs(norm - 1.0) <= _UNIT:
        raise ValueError(f"found a quaternion {quaternion_xyzw} of length {norm:g}, allowed: 1, to {_UNIT:g}")
    pose = np.eye(4)
    pose[:3, :3] = rotation_of(normalized((x, y, z, w)))
    pose[:3, 3] = translation
    return pose


def pinhole(f_x: float, f_y: float, c_x: float, c_y: float, skew: float = 0.0) -> Floats:
    """(3, 3) intrinsics."""
    return np.array([[f_x, skew, c_x], [0.0, f_y, c_y], [0.0, 0.0, 1.0]])
