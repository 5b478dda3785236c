"""Memory of pictures and stages: on large pages where the system has them, and used again once nobody can see it.

A frame with all its stages is 65 MB at 640 x 480: fresh from the system, 16,000 page faults a frame.
"""

from __future__ import annotations

import ctypes
import math
import mmap
import weakref
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

Layout = tuple[type[np.generic], tuple[int, ...]]
"""Type and shape of an array."""

_MOST_FREE = 1 << 28
"""Bytes that are kept for later at most."""

_GAP = 192
"""Bytes between arrays, at least: pictures of equal size would otherwise begin at the same line of the cache."""

_free: list[Any] = []
"""Blocks that nobody sees; the one that was given back last stands last."""


def _new(size: int) -> Any:
    """Memory that the system has to give: an object with a writable buffer."""
    if not hasattr(mmap, "MADV_HUGEPAGE"):
        return np.empty(size, np.uint8)
    try:
        block = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    except OSError:
        raise MemoryError(f"{size / 2**30:.1f} GiB are needed for the arrays of a frame, more than there is") from None
    with suppress(OSError):  # a system built without large pages
        block.madvise(mmap.MADV_HUGEPAGE)
    return block


def _give_back(block: Any) -> None:
    _free.append(block)
    while sum(len(kept) for kept in _free) > _MOST_FREE:
        _free.pop(0)


def _block(size: int) -> NDArray[np.uint8]:
    """Memory for `size` bytes; when the last array that lies in it is gone it goes back to `_free`."""
    fitting = [i for i, block in enumerate(_free) if size <= len(block) <= 2 * size]
    block = _free.pop(fitting[-1]) if fitting else _new(size)
    seen: Any = (ctypes.c_ubyte * len(block)).from_buffer(block)  # the arrays' base: it lives as long as any of them
    weakref.finalize(seen, _give_back, block).atexit = False
    array: NDArray[np.uint8] = np.frombuffer(seen, np.uint8)
    return array


def arrays(layouts: Sequence[Layout]) -> list[NDArray[Any]]:
    """Arrays in one piece of memory, not initialized. It stays in use as long as any of them does."""
    sizes = [math.prod(shape) * np.dtype(dtype).itemsize for dtype, shape in layouts]
    places, end = [], 0
    for size in sizes:
        places.append(end)
        end = -(-(end + size + _GAP) // 64) * 64
    block = _block(max(end, 1))
    return [
        block[place : place + size].view(dtype).reshape(shape)
        for place, size, (dtype, shape) in zip(places, sizes, layouts, strict=True)
    ]
