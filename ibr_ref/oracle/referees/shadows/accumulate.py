"""Stage accumulate: the sum of all light samples' shadows, each times 1 / N."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.referees.shadows.model import Model


def accumulated(model: Model, shadows: Sequence[Bounded]) -> Bounded:
    """The sum of N shadows (n,)."""
    return model.bounded(model.program.accumulated([model.number(shadow) for shadow in shadows]))


def in_bytes(found: Floats, device: Device) -> Bools:
    """Which numbers of a port may be what an 8-bit buffer holds: k / 255, as a quotient or a product with its inverse."""
    with np.errstate(invalid="ignore", over="ignore"):
        steps = np.rint(255.0 * found)
        return np.asarray(np.abs(found - steps / 255.0) <= (device.quotient + device.operation) * UNIT, np.bool_)
