"""Memory of pictures: apart while anybody sees it, used again afterwards."""

from __future__ import annotations

import mmap

import numpy as np
import pytest

from ibr_ref.pipeline import memory

LAYOUT = [(np.float64, (40, 3)), (np.int32, (40,)), (np.bool_, (40,)), (np.float64, (0,))]


def test_arrays_have_their_types_and_shapes_and_do_not_overlap() -> None:
    made = memory.arrays(LAYOUT)
    assert [(array.dtype, array.shape) for array in made] == [(np.dtype(dtype), shape) for dtype, shape in LAYOUT]
    assert all(array.flags.c_contiguous and array.flags.aligned and array.flags.writeable for array in made)
    for value, array in enumerate(made):
        array[...] = value
    assert [set(array.ravel().tolist()) for array in made[:3]] == [{0.0}, {1}, {True}]


def test_memory_that_is_seen_is_not_used_again() -> None:
    first = memory.arrays(LAYOUT)
    view = first[0][5:7, 1]
    del first
    second = memory.arrays(LAYOUT)
    assert not any(np.shares_memory(view, array) for array in second)


def test_memory_that_nobody_sees_any_more_is_used_again() -> None:
    first = memory.arrays([(np.uint8, (1 << 20,))])
    place = first[0].ctypes.data
    del first
    assert memory.arrays([(np.uint8, (1 << 20,))])[0].ctypes.data == place


def test_only_so_much_is_kept_for_later() -> None:
    held = [memory.arrays([(np.uint8, (memory._MOST_FREE // 3,))]) for _ in range(4)]
    held.clear()
    assert sum(len(block) for block in memory._free) <= memory._MOST_FREE


@pytest.mark.skipif(not hasattr(mmap, "MADV_HUGEPAGE"), reason="other systems' memory comes from NumPy, which says it")
def test_what_would_have_been_needed_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*arguments: object, **options: object) -> None:
        raise OSError(12, "Cannot allocate memory")

    monkeypatch.setattr(memory.mmap, "mmap", refused)
    with pytest.raises(MemoryError, match=r"^12\.0 GiB are needed for the arrays of a frame, more than there is$"):
        memory.arrays([(np.float64, (3 * 2**29,))])
