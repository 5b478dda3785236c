"""Checks that all descriptions share. Every error names the field, the value found and what is allowed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Vector = tuple[float, float, float]


LONGEST_VALUE, LONGEST_NAME, LONGEST_MESSAGE = 200, 600, 1500
"""Characters that errors show of a value, of a file's name, and in all."""


def reject(field: str, found: object, allowed: str) -> ValueError:
    """The error for a field's value: ``raise reject("height_scale", -1.0, "> 0")``."""
    try:
        text = repr(found)
    except Exception:  # a number with more digits than Python prints, say
        text = f"a {type(found).__name__} that cannot be shown"
    return ValueError(f"{field}: found {one_line(text)}, allowed: {allowed}")


def one_line(text: object, longest: int = LONGEST_VALUE) -> str:
    """What errors show of a text: on one line, nothing that a terminal obeys, the middle left out where it is too long."""
    return _bounded(" ".join(str(text).split()), longest)


def named(path: str | PathLike[str]) -> str:
    """What errors call a file: its path, as `one_line` has it, but with its own spaces."""
    return _bounded(str(Path(path)), LONGEST_NAME)


def _bounded(text: str, longest: int) -> str:
    if len(text) > longest:
        half = (longest - 5) // 2
        text = f"{text[:half]} ... {text[-half:]}"
    return text if text.isprintable() else "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def number(
    field: str, value: Any, *, low: float = -math.inf, above: float = -math.inf, high: float = math.inf
) -> float:
    """A finite float with low <= value <= high and value > above."""
    allowed = "a finite number"
    allowed += f" > {above:g}" if above > -math.inf else f" >= {low:g}" if low > -math.inf else ""
    allowed += f", <= {high:g}" if high < math.inf else ""
    try:
        if isinstance(value, (bool, np.bool_, str)):
            raise reject(field, value, allowed)
        result = float(value)
    except (TypeError, ValueError, OverflowError):
        raise reject(field, value, allowed) from None
    if not math.isfinite(result) or not low <= result <= high or result <= above:
        raise reject(field, value, allowed)
    return result


def whole(field: str, value: Any, *, low: int, high: int) -> int:
    """An integer in [low, high]; 3.0 is one, 3.5 and True are not."""
    allowed = f"a whole number from {low} to {high}"
    try:
        if isinstance(value, (bool, np.bool_, str)) or int(value) != value:
            raise reject(field, value, allowed)
    except (TypeError, ValueError, OverflowError):
        raise reject(field, value, allowed) from None
    if not low <= value <= high:
        raise reject(field, value, allowed)
    return int(value)


def choice(field: str, value: object, allowed: Sequence[str]) -> None:
    """One of the given words."""
    if not isinstance(value, str) or value not in allowed:
        raise reject(field, value, " | ".join(allowed))


def numbers(field: str, value: Any, allowed: str) -> NDArray[np.float64]:
    """A new C-ordered float64 array of what can be one: not of ragged lists, complex numbers, words."""
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "buif":
            raise TypeError
        return np.array(array, np.float64, order="C")
    except (TypeError, ValueError, OverflowError):
        raise reject(field, value, allowed) from None


def finite_rows(field: str, array: NDArray[np.float64]) -> None:
    """Raise ValueError for the first row of an array (N, K) that is not finite."""
    bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if len(bad):
        raise reject(f"{field}[{bad[0]}]", array[bad[0]].tolist(), "finite numbers")


def vector(field: str, value: ArrayLike, length: int = 3) -> NDArray[np.float64]:
    """A read-only float64 array of `length` finite numbers."""
    allowed = f"{length} finite numbers"
    array = numbers(field, value, allowed)
    if array.shape != (length,) or not np.isfinite(array).all():
        raise reject(field, value, allowed)
    return frozen(array)


def color(field: str, value: ArrayLike) -> NDArray[np.float64]:
    """A read-only (3,) float64 array of numbers in [0, 1]."""
    array = vector(field, value)
    if not ((array >= 0.0) & (array <= 1.0)).all():
        raise reject(field, array.tolist(), "numbers in [0, 1]")
    return array


def matrix(field: str, value: ArrayLike, rows: int, columns: int) -> NDArray[np.float64]:
    """A read-only float64 array of rows x columns finite numbers."""
    allowed = f"a {rows} x {columns} matrix of finite numbers"
    array = numbers(field, value, allowed)
    if array.shape != (rows, columns) or not np.isfinite(array).all():
        raise reject(field, value, allowed)
    return frozen(array)


def texture(field: str, value: ArrayLike, channels: int) -> NDArray[np.float64]:
    """A read-only, C-ordered float64 copy of an image: (H, W), or (H, W, 3); every texel in [0, 1]."""
    shape = "(H, W)" if channels == 1 else f"(H, W, {channels})"
    array = numbers(field, value, f"an array {shape} of numbers in [0, 1]")
    if array.ndim != (2 if channels == 1 else 3) or array.size == 0 or (channels > 1 and array.shape[2] != channels):
        raise reject(f"{field}.shape", array.shape, f"{shape}, not empty")
    if array.size >= 2**31:
        raise reject(f"{field}.size", array.size, "fewer than 2^31 numbers")
    bad = ~((array >= 0.0) & (array <= 1.0))
    if bad.any():
        where = tuple(int(i) for i in np.argwhere(bad)[0])
        raise reject(f"{field}{list(where)}", float(array[where]), "numbers in [0, 1]")
    return frozen(array)


def frozen(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same array, read-only from now on."""
    array.setflags(write=False)
    return array


def rows(value: tuple[int, int] | None, height: int) -> tuple[int, int]:
    """(first, stop) of a picture's rows, 0 <= first < stop <= height; None: all."""
    if value is None:
        return 0, height
    allowed = f"first and stop, 0 <= first < stop <= {height}"
    try:
        first, stop = value
    except (TypeError, ValueError):
        raise reject("rows", value, allowed) from None
    low, high = whole("rows[0]", first, low=0, high=height - 1), whole("rows[1]", stop, low=1, high=height)
    if not low < high:
        raise reject("rows", (low, high), allowed)
    return low, high
