"""Bézier patch files (.bpt), the form in which Newell's teapot is handed on.

Two dialects, told by the second line; numbers are separated by spaces or commas, blank lines are skipped. By index:

    32                          the number of patches
    1,2,3,4,5, ... 16           a line a patch: its 4 x 4 control points, counted from 1, row by row
    306                         the number of points
    1.4,0.0,2.4                 a line a point: x, y, z

and one after the other:

    32                          the number of patches
    3 3                         for every patch its degrees, which must be 3 and 3,
    1.4 0.0 2.4                 and 16 lines with its control points
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.words import real, shown, whole

_CORNERS = 16
_LARGEST = 1e300
"""Of a coordinate: weighted means of such do not overflow."""
_MOST = 2**31
"""Meshes count in 32 bits."""


def decode(data: bytes) -> NDArray[np.float64]:
    """Control points (P, 4, 4, 3), the rows of the file along the second axis.

    Raises ValueError, with the line, for what is no such file, or not all there, or goes on after its end. A number of
    patches or points is believed only as far as there are lines for them.
    """
    lines = _Lines(data)
    count = lines.count("the number of patches")
    indexed = lines.width == _CORNERS
    patches = _by_index(lines, count) if indexed else _one_after_the_other(lines, count)
    lines.finish()
    return patches


class _Lines:
    """The lines that are not blank, read one after the other."""

    def __init__(self, data: bytes) -> None:
        rows = [(number, text.split()) for number, text in enumerate(data.replace(b",", b" ").split(b"\n"), 1)]
        self.rows = [(number, words) for number, words in rows if words]
        self.place = 0

    @property
    def width(self) -> int:
        """Words in the line that comes next; 0 at the end."""
        return len(self.rows[self.place][1]) if self.place < len(self.rows) else 0

    def words(self, allowed: str) -> list[bytes]:
        """Those of the next line, which goes on being the one that `refused` names."""
        if self.place == len(self.rows):
            raise ValueError(f"found the end of the file, allowed: {allowed}")
        self.place += 1
        return self.rows[self.place - 1][1]

    def refused(self, allowed: str) -> ValueError:
        """The error for the line read last."""
        number, words = self.rows[self.place - 1]
        return ValueError(f"found {shown(words)} in line {number}, allowed: {allowed}")

    def whole(self, amount: int, most: int, allowed: str) -> list[int]:
        """A line of so many numbers from 1 to `most`."""
        words = self.words(allowed)
        try:
            numbers = [whole(word) for word in words]
        except ValueError:
            raise self.refused(allowed) from None
        if len(numbers) != amount or min(numbers) < 1 or max(numbers) > most:
            raise self.refused(allowed)
        return numbers

    def count(self, of: str) -> int:
        """A line with one number, >= 1."""
        return self.whole(1, _MOST, f"{of}, from 1 to {_MOST}")[0]

    def point(self) -> list[float]:
        """A line with x, y and z."""
        allowed = f"x, y and z, numbers between {-_LARGEST:g} and {_LARGEST:g}"
        words = self.words(allowed)
        try:
            numbers = [real(word) for word in words]
        except ValueError:
            raise self.refused(allowed) from None
        if len(numbers) != 3 or not all(abs(number) <= _LARGEST for number in numbers):
            raise self.refused(allowed)
        return numbers

    def finish(self) -> None:
        """Raise ValueError if there are more lines."""
        if self.width:
            self.place += 1
            raise self.refused("nothing after the last point")


def _by_index(lines: _Lines, count: int) -> NDArray[np.float64]:
    """The points come after the indices: that these exist is checked when their number is known."""
    start = lines.place
    indices = [lines.whole(_CORNERS, _MOST, "16 indices of points, from 1 up") for _ in range(count)]
    amount = lines.count("the number of points")
    points: NDArray[np.float64] = np.array([lines.point() for _ in range(amount)])
    for place, row in enumerate(indices, start + 1):
        if max(row) > amount:
            lines.place = place
            raise lines.refused(f"16 indices of points, from 1 to {amount}")
    patches: NDArray[np.float64] = points[np.array(indices) - 1].reshape(count, 4, 4, 3)
    return patches


def _one_after_the_other(lines: _Lines, count: int) -> NDArray[np.float64]:
    points = []
    for _ in range(count):
        allowed = "3 3, the degrees of a bicubic patch"
        if lines.words(allowed) != [b"3", b"3"]:
            raise lines.refused(allowed)
        points.append([lines.point() for _ in range(_CORNERS)])
    return np.reshape(points, (count, 4, 4, 3))
