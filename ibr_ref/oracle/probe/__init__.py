"""Devices measured: cases from which a port's own arrays say with which numbers its device computes.

What no value of a number explains by far better than the others is assumed as the profile grants it. What a device does that
no standard allows is a fault of its driver, with a name in `DRIVER_FAULTS`.
"""

from __future__ import annotations

from ibr_ref.methods import Room
from ibr_ref.oracle.probe.measured import DRIVER_FAULTS, Measured

PROBES: dict[str, Room] = {
    "probe-polygons": Room("ibr_ref.oracle.probe.polygons"),
    "probe-sprites": Room("ibr_ref.oracle.probe.sprites"),
    "probe-arithmetic": Room("ibr_ref.oracle.probe.arithmetic"),
}
"""By the names of their cases: `probe_case()`, and `measure(case, arrays)` of a port's arrays, which raises ValueError for
those that are missing or have another size."""

__all__ = ["DRIVER_FAULTS", "PROBES", "Measured"]
