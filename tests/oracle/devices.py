"""Devices at random: what the bounds are sampled with."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.arithmetic.device import Policy


def random_policy(random: np.random.Generator, profile: str | None = None) -> tuple[Policy, str]:
    """Any device that a profile (any) has room for, by the numbers of device.py, and that profile."""
    profile = profile or str(random.choice(["ieee32", "d3d11", "vulkan", "webgpu", "gl"]))
    loose, loosest = profile != "ieee32", profile == "gl"
    quotients = str(random.choice(["rounded", "reciprocal", "loose"])) if profile in ("vulkan", "webgpu", "gl") else ""
    return Policy(
        backwards=bool(random.integers(2)),
        fused=bool(random.integers(2)),
        reciprocal=quotients == "reciprocal",
        loose=2 if quotients == "loose" else 0,
        truncated=profile == "d3d11" and bool(random.integers(2)),
        jitter=int(random.integers(3)) if loosest else 0,
        seed=int(random.integers(1 << 30)),
        weight_bits=8 if loose and random.integers(2) else None,
        weight_rounding=str(random.choice(["nearest", "down"])),
        subpixel_rounding=str(random.choice(["even", "up", "down"])) if loose else "even",
        snapped_varyings=profile not in ("webgpu", "gl") or bool(random.integers(2)),
        depth_bits=24 if loose and random.integers(2) else None,
        color_bits=8 if random.integers(3) == 0 else None,
    ), profile
