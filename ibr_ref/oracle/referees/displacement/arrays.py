"""Bounded numbers as arrays: put together, and picked from."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ibr_ref.oracle.accept.bounded import Bounded


def stacked(parts: Sequence[Bounded]) -> Bounded:
    """Components as the last axis."""
    values = np.broadcast_arrays(*(p.value for p in parts))
    errors = np.broadcast_arrays(*(p.error for p in parts), values[0])[:-1]
    return Bounded(np.stack(values, axis=-1), np.stack(errors, axis=-1), parts[0].device)


def joined(parts: Sequence[Bounded]) -> Bounded:
    """Along the first axis."""
    return Bounded(
        np.concatenate([p.value for p in parts]),
        np.concatenate([np.broadcast_to(p.error, p.value.shape) for p in parts]),
        parts[0].device,
    )
