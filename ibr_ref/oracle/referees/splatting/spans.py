"""Which pixels a splat covers along each axis, for certain or perhaps.

A splat of width w at c covers the centres in [snap(c) - w/2, snap(c) + w/2). A border may be off by what c may be off,
snapped; by half of what w may be off; by what the device's primitives add (`Device.splat_border`); and by two roundings,
one of c -+ w/2 and one of the comparison, where these numbers are not floats themselves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ibr_ref.array_types import Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.coverage import RASTER
from ibr_ref.oracle.device import UNIT, Device

ROUNDINGS = 2.0
"""Of a border: c -+ w/2, and the half pixel that is taken from it, or the comparison with a pixel's centre."""


class Axis(NamedTuple):
    """Of n splats, along one axis. The reference's span lies between the certain and the possible one."""

    first: Ints
    """The first pixel that may be covered."""
    stop: Ints
    """The one after the last."""
    sure_first: Ints
    """The same of the pixels that certainly are."""
    sure_stop: Ints
    low: Floats
    """Where the snapped centre may lie, at least."""
    high: Floats
    reference: Floats
    """Where the reference has it."""


def axis(center: Bounded, width: Bounded, size: int) -> Axis:
    """The spans of splats on an axis of `size` pixels."""
    device = center.device
    low, high, reference = (np.rint(RASTER * c) / RASTER for c in (center.low, center.high, center.value))
    least, most = np.maximum(width.low, 0.0) / 2.0, width.high / 2.0
    off = border(reference, width, device)
    first, stop = np.ceil(low - most - 0.5 - off), np.ceil(high + most - 0.5 + off)
    sure_first, sure_stop = np.ceil(high - least - 0.5 + off), np.ceil(low + least - 0.5 - off)
    first, stop, sure_first, sure_stop = (
        np.clip(np.nan_to_num(end), 0, size).astype(np.int64) for end in (first, stop, sure_first, sure_stop)
    )
    return Axis(first, stop, sure_first, sure_stop, low - device.splat_border, high + device.splat_border, reference)


def border(center: Floats, width: Bounded, device: Device) -> Floats:
    """How far a border may lie from centre -+ width/2, besides what their own errors make of it."""
    rounding = ROUNDINGS * device.operation * UNIT * (np.abs(center) + width.size / 2.0 + 0.5)
    if device.splat_border == 0.0 and device.operation <= 1.0:
        ends = [end for sign in (-0.5, 0.5) for end in (center + sign * width.value, center + sign * width.value - 0.5)]
        # A correctly rounded sum that is a float is exact: IEEE 754-2019, 4.3.
        exactly = np.logical_and.reduce([end == end.astype(np.float32) for end in ends]) & (width.error == 0.0)
        rounding = np.where(exactly, 0.0, rounding)
    return device.splat_border + rounding
