"""Roundings in a row, and what lies between two numbers."""

from __future__ import annotations

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Floats
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.device import Device


def gamma(device: Device, operations: float, quotients: float = 0.0) -> float:
    """Largest relative error of so many operations in a row (Higham 2002, lemma 3.1)."""
    unit = (operations * device.operation + quotients * device.quotient) * UNIT
    return unit / (1.0 - unit)


def centered(low: Floats, high: Floats, device: Device) -> Bounded:
    """Everything between two numbers, both included whatever is rounded here."""
    middle = (low + high) / 2.0
    return Bounded(middle, np.maximum(high - middle, middle - low), device)
