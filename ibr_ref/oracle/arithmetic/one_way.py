"""Searches on a device: what `ways.Ways` follows every way of goes one."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Ints


class OneWay:
    """Of a device."""

    def parted(self, truth: Any) -> tuple[Bools, Bools]:
        """Where a comparison holds, and where it does not."""
        holds = np.asarray(truth, np.bool_)
        return holds, ~holds

    def wholes(self, x: Any) -> tuple[Ints, Ints]:
        """Rows, and floor(x) of them."""
        return np.arange(len(x)), np.floor(x).astype(np.int64)

    def explored(self) -> _NotExplored:
        """What tells states apart."""
        return _NotExplored()

    def one_end(self, like: Any, rows: Ints, kinds: Ints, x: Any) -> tuple[Ints, Any]:
        """The end of each search, as many as `like` has rows: its kind, -1 of those that have none, and its number, 0 there.

        rows: which search ends so. kinds: >= 0.
        """
        kind, found = np.full(len(like), -1), np.zeros(len(like))
        kind[rows], found[rows] = kinds, x
        return kind, found


class _NotExplored:
    """No state comes again."""

    def fresh(self, keys: Ints, x: Any) -> tuple[Ints, Any]:
        """All of them."""
        return np.arange(len(keys)), x
