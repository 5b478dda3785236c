"""Accessors as arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.gltf.buffers import Buffers
from ibr_ref.io.gltf.document import Accessor, Document, Sparse, member, refused

Array = NDArray[np.generic]

_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
_MOST_ZEROS = 2**20
"""Elements of an accessor that no bytes stand for."""


def _largest(stored: Array) -> int:
    """The largest number of the type of whole numbers."""
    return (1 << (8 * stored.dtype.itemsize - (stored.dtype.kind == "i"))) - 1


class Accessors:
    """The accessors of a document."""

    def __init__(self, document: Document, buffers: Buffers) -> None:
        self._document, self._buffers = document, buffers

    def described(self, index: int) -> Accessor:
        """What the document says of one."""
        return member(self._document.accessors, index, "accessors")

    def numbers(self, index: int) -> NDArray[np.float64]:
        """(count, width) real numbers; normalized integers are shares of the largest, -1 or above."""
        accessor, stored = self.described(index), self._stored(index)
        numbers: NDArray[np.float64] = stored.astype(np.float64)
        if not accessor.normalized:
            return numbers
        if stored.dtype.kind == "f" or stored.dtype.itemsize > 2:
            raise refused(f"accessors.{index}.normalized", "true", "for integers of 8 and 16 bits")
        return np.asarray(np.maximum(numbers / _largest(stored), -1.0), np.float64)

    def indices(self, index: int) -> NDArray[np.int64]:
        """(count,) indices. Raises ValueError for accessors of other numbers, and the index that restarts a strip."""
        accessor = self.described(index)
        if accessor.type != "SCALAR" or accessor.componentType not in (5121, 5123, 5125) or accessor.normalized:
            kind = f"{accessor.type} {accessor.componentType}{' normalized' if accessor.normalized else ''}"
            raise refused(f"accessors.{index}", kind, "indices: SCALAR, 5121, 5123 or 5125, not normalized")
        stored = self._stored(index)[:, 0]
        largest = _largest(stored)
        if (stored == largest).any():
            raise refused(f"accessors.{index}", f"the index {largest}", f"indices up to {largest - 1}")
        return stored.astype(np.int64)

    def _stored(self, index: int) -> Array:
        """(count, width) numbers as the file has them."""
        accessor, name = self.described(index), f"accessors.{index}"
        if accessor.type not in _WIDTHS:
            raise refused(f"{name}.type", accessor.type, " | ".join(_WIDTHS))
        width, kind = _WIDTHS[accessor.type], np.dtype(_TYPES[accessor.componentType])
        if accessor.bufferView is None:
            if accessor.count > _MOST_ZEROS:
                raise refused(f"{name}.count", accessor.count, f"up to {_MOST_ZEROS}, without bytes for them")
            stored: Array = np.zeros((accessor.count, width), kind)
        else:
            stride = member(self._document.bufferViews, accessor.bufferView, "bufferViews").byteStride
            stored = self._array(name, accessor.bufferView, accessor.byteOffset, (accessor.count, width), kind, stride)
        return stored if accessor.sparse is None else self._replaced(name, stored, accessor.sparse)

    def _replaced(self, name: str, stored: Array, sparse: Sparse) -> Array:
        """With the elements that a sparse accessor replaces."""
        where, what = sparse.indices, sparse.values
        kind = np.dtype(_TYPES[where.componentType])
        rows = self._array(f"{name}.sparse", where.bufferView, where.byteOffset, (sparse.count, 1), kind, None)
        places = rows[:, 0].astype(np.int64)
        if places[-1] >= len(stored) or (np.diff(places) <= 0).any():
            raise refused(f"{name}.sparse.indices", "indices out of order", f"rising ones, from 0 to {len(stored) - 1}")
        shape = (sparse.count, stored.shape[1])
        values = self._array(f"{name}.sparse", what.bufferView, what.byteOffset, shape, stored.dtype, None)
        result = stored.copy()
        result[places] = values
        return result

    def _array(
        self, name: str, view: int, offset: int, shape: tuple[int, int], kind: np.dtype[np.generic], stride: int | None
    ) -> Array:
        """Elements of a buffer view, `stride` bytes from one to the next."""
        data = self._buffers.view(view)
        size = shape[1] * kind.itemsize
        step = stride or size
        end = offset + step * (shape[0] - 1) + size
        if step < size or end > len(data):
            found = f"{shape[0]} elements of {size} bytes, {step} apart, up to byte {end}"
            raise refused(name, found, f"up to {len(data)}, as bufferViews.{view} has")
        return np.ndarray(shape, kind, data, offset, (step, kind.itemsize))
