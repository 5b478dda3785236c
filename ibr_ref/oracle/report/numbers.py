"""What the inspector shows of each pixel, within a budget: whole tiles, those first where something is wrong.

Numbers are float32 or int32. A port's are kept as what of their bits differs from the reference's, and the bytes of equal
weight stand together, so that they pack well.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.examination import Examination

TILE = 16
"""Pixels a side."""

_LEVEL = 6
_SPREAD = 0.6180339887498949
"""The golden ratio's: multiples of it, without their whole parts, are spread evenly."""

Pair = tuple[NDArray[np.generic], NDArray[np.generic] | None]


def planes(examination: Examination) -> Mapping[str, Pair]:
    """(reference, port) by array, (H, W) or (H, W, k), k <= 4."""
    case, handed = examination.case, examination.handed
    size = case.frame.color.shape[:2]
    found: dict[str, Pair] = {}
    for name, ours in {"color": case.frame.color, "depth": case.frame.depth, **case.frame.stages}.items():
        if isinstance(ours, tuple) or ours.shape[:2] != size or ours[0, 0].size > 4:
            continue
        port = handed.get(name)
        if port is not None and np.asarray(port).dtype == np.uint8:
            port = np.asarray(port) / 255.0
        found[name] = (ours, None if port is None else np.asarray(port))
    return found


def packed(examination: Examination, budget: int) -> dict[str, Any]:
    """All that fits into so many characters: the tiles that are kept, and their numbers array by array."""
    arrays, order = planes(examination), _order(examination)
    share = 1.0
    while True:
        kept = order[: max(1, round(share * len(order)))]
        found = [_array(examination, name, pair, kept) for name, pair in arrays.items()]
        size = sum(len(text) for array in found for text in array.values() if isinstance(text, str))
        if size <= budget or len(kept) == 1:
            return {"tile": TILE, "tiles": len(order), "kept": kept.tolist(), "arrays": found}
        share = min(0.9 * share * budget / size, 0.9 * share)


def _array(examination: Examination, name: str, pair: Pair, kept: Ints) -> dict[str, Any]:
    reference, port = pair
    integers = reference.dtype.kind in "biu" and (port is None or port.dtype.kind in "biu")
    kind = "<i4" if integers else "<f4"
    with np.errstate(all="ignore"):  # a port's numbers may be too large for float32
        ours = _tiles(np.asarray(reference).astype(kind), kept).view("<u4")
        theirs = None if port is None else _tiles(port.astype(kind), kept).view("<u4")
    wrong = _blamed(examination, name)
    return {
        "name": name,
        "kind": "int" if integers else "float",
        "channels": int(np.prod(reference.shape[2:], dtype=int)),
        "reference": _deflated(ours),
        "port": None if theirs is None else "" if np.array_equal(ours, theirs) else _deflated(ours ^ theirs),
        "wrong": None if wrong is None else _deflated(_tiles(wrong.astype("<u4"), kept)),
    }


def _tiles(array: NDArray[Any], kept: Ints) -> NDArray[Any]:
    """(tiles, TILE, TILE, channels) of a plane, 0 beyond its borders."""
    height, width = array.shape[:2]
    across, down = -(-width // TILE), -(-height // TILE)
    whole = np.zeros((down * TILE, across * TILE, *array.shape[2:]), array.dtype)
    whole[:height, :width] = array
    cut = whole.reshape(down, TILE, across, TILE, -1).swapaxes(1, 2)
    return np.ascontiguousarray(cut.reshape(down * across, TILE, TILE, -1)[kept])


def _deflated(numbers: NDArray[Any]) -> str:
    """Of 32-bit numbers, all lowest bytes first."""
    by_weight = np.ascontiguousarray(numbers.reshape(-1).view(np.uint8).reshape(-1, 4).T)
    return base64.b64encode(zlib.compress(by_weight.tobytes(), _LEVEL)).decode("ascii")


def _order(examination: Examination) -> Ints:
    """All tiles: those with something wrong, then those with something undecided, then the others, each evenly spread."""
    size = examination.case.frame.color.shape[:2]
    judged = [j for j in examination.judgements if j.wrong.shape == size]
    rank = np.full((-(-size[0] // TILE)) * (-(-size[1] // TILE)), 2)
    every = np.arange(len(rank))
    for value, marks in ((1, [j.undecided for j in judged]), (0, [j.wrong for j in judged])):
        for mark in marks:
            rank[_tiles(mark, every).any(axis=(1, 2, 3))] = value
    for witness in examination.verdict.witnesses:
        if witness.element == "pixel":
            row, column = witness.index[-2:]
            rank[row // TILE * -(-size[1] // TILE) + column // TILE] = -1
    return np.lexsort((every * _SPREAD % 1.0, rank))


def _blamed(examination: Examination, array: str) -> Bools | None:
    """(H, W) where the array is the first in which a wrong stage, or the picture, disagrees; None: nowhere."""
    result = np.zeros(examination.case.frame.color.shape[:2], np.bool_)
    for judgement in examination.judgements:
        if judgement.wrong.shape == result.shape and array in judgement.arrays:
            result |= judgement.wrong & (judgement.blame == judgement.arrays.index(array))
    return result if result.any() else None
