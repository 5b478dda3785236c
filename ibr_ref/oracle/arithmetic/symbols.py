"""Which rows of two numbers belong to one symbol, and rows as compiled operations take them."""

from __future__ import annotations

from functools import lru_cache, reduce

import numpy as np

from ibr_ref.affine.rows import SLOPES
from ibr_ref.array_types import Floats, Ints

Names = tuple[str, ...]


@lru_cache(4096)
def united(first: Names, second: Names) -> tuple[Names, Ints, Ints]:
    """The symbols of two numbers, the first one's before; and for each its row in either, -1 where it has none."""
    names = tuple(dict.fromkeys((*first, *second)))
    return names, places(names, first), places(names, second)


@lru_cache(4096)
def all_of(*each: Names) -> Names:
    """The symbols of several numbers, in order of appearance."""
    return reduce(lambda names, more: united(names, more)[0], each, ())


@lru_cache(4096)
def places(names: Names, of: Names) -> Ints:
    """For each symbol its row in a number with symbols `of`, -1 where it has none."""
    found = {name: k for k, name in enumerate(of, SLOPES)}
    return np.array([found.get(name, -1) for name in names], np.int64)


def together(*shapes: tuple[int, ...]) -> tuple[int, ...]:
    """The shape that several broadcast to: `numpy.broadcast_shapes`, which takes as long as an operation, where it must."""
    found: tuple[int, ...] = ()
    for shape in shapes:
        if shape and shape != found:
            if found:
                return np.broadcast_shapes(*shapes)
            found = shape
    return found


def shaped(rows: Floats, shape: tuple[int, ...]) -> Floats:
    """(3 + K, *shape), a view where it is one already."""
    if rows.shape[1:] == shape:
        return rows
    lengthened = rows.reshape(len(rows), *(1,) * (len(shape) + 1 - rows.ndim), *rows.shape[1:])
    return np.broadcast_to(lengthened, (len(rows), *shape))


def flat(rows: Floats, shape: tuple[int, ...]) -> Floats:
    """(3 + K, n), or (3 + K, 1) of what is the same everywhere; one after the other in memory, for compiled code."""
    if rows.ndim == 1:
        rows = rows.reshape(len(rows), 1)
    elif rows.shape[1:] != shape or rows.ndim != 2:
        rows = shaped(rows, shape).reshape(len(rows), -1)
    flags = rows.flags
    return rows if flags.c_contiguous and flags.writeable else rows.copy()


def over_symbols(rows: Floats, of: Names, names: Names) -> Floats:
    """The rows of a number with symbols `of` along `names`, which hold them: 0 along others."""
    if of == names:
        return rows
    result = np.zeros((SLOPES + len(names), *rows.shape[1:]))
    result[:SLOPES] = rows[:SLOPES]
    for k, at in enumerate(places(names, of), SLOPES):
        if at >= 0:
            result[k] = rows[at]
    return result
