"""Gathers and nothing else: the kernel that `gathers` measures."""

from __future__ import annotations

from typing import Any

from ibr_ref.jit import device, kernel, prange


@device
def _sum(texture: Any, indices: Any, first: int, last: int) -> Any:
    a = b = c = d = 0.0  # four sums: additions that wait for each other would be what is measured
    for i in range(first, last - 3, 4):
        a += texture[indices[i]]
        b += texture[indices[i + 1]]
        c += texture[indices[i + 2]]
        d += texture[indices[i + 3]]
    return a + b + c + d


@kernel
def gather_sums(texture: Any, indices: Any, sums: Any) -> None:
    """Sum, in as many parts as `sums` has, of the texels that the indices name."""
    parts = len(sums)
    for part in prange(parts):
        sums[part] = _sum(texture, indices, len(indices) * part // parts, len(indices) * (part + 1) // parts)
