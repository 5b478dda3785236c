"""Gathers and nothing else: the kernel that `gathers` measures."""

from __future__ import annotations

from ibr_ref.array_types import Floats, Indices, Texels
from ibr_ref.jit import device, kernel, prange


@device
def _sum(texture: Texels, indices: Indices, first: int, last: int) -> float:
    a = b = c = d = 0.0  # four sums: additions that wait for each other would be what is measured
    for i in range(first, last - 3, 4):
        a += texture[indices[i]]
        b += texture[indices[i + 1]]
        c += texture[indices[i + 2]]
        d += texture[indices[i + 3]]
    return a + b + c + d


@kernel
def gather_sums(texture: Texels, indices: Indices, sums: Floats) -> None:
    """Sum, in as many parts as sums (S,) has, of the texels that the indices (N,) name."""
    parts = len(sums)
    for part in prange(parts):
        sums[part] = _sum(texture, indices, len(indices) * part // parts, len(indices) * (part + 1) // parts)
