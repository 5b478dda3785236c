"""Devices at random: what the bounds are sampled with."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import PROFILES


def random_policy(random: np.random.Generator, profile: str | None = None) -> tuple[Policy, str]:
    """Any device that a profile (any) has room for, by the numbers of device.py, and that profile."""
    profile = profile or str(random.choice([*PROFILES]))
    device = PROFILES[profile]
    quotients = str(random.choice(["rounded", "reciprocal", "loose"])) if device.quotient >= 5.0 else ""
    return Policy(
        backwards=bool(random.integers(2)),
        fused=bool(random.integers(2)),
        reciprocal=quotients == "reciprocal",
        loose=2 if quotients == "loose" else 0,
        truncated=2.0 <= device.operation < 5.0 and bool(random.integers(2)),
        jitter=int(random.integers(3)) if device.operation >= 5.0 else 0,
        seed=int(random.integers(1 << 30)),
        weight_bits=8 if device.weight_step and random.integers(2) else None,
        weight_rounding=str(random.choice(["nearest", "down"])),
        subpixel_rounding=str(random.choice(["even", "up", "down"])) if device.subpixel_any else "even",
        snapped_varyings=not device.unsnapped or bool(random.integers(2)),
        depth_bits=24 if device.depth_step and random.integers(2) else None,
        color_bits=8 if random.integers(3) == 0 else None,
    ), profile
