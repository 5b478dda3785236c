"""Arrays of stages as pictures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bytes
from ibr_ref.contract import StageArray, described

MOST_LAYERS = 16
"""Of an array of maps or samples that are listed one by one."""

_NOTHING = (96, 96, 104)
_VIRIDIS = "440154 472d7b 3b528b 2c728e 21918c 28ad81 5ec962 aadc32 fde725"
_STOPS = np.array([list(bytes.fromhex(stop)) for stop in _VIRIDIS.split()])
_RAMP = np.stack([np.interp(np.linspace(0, 8, 256), np.arange(9), stops) for stops in _STOPS.T], axis=-1)
"""(256, 3) bytes of a colour map whose lightness grows, from low to high."""


@dataclass(frozen=True)
class Picture:
    """An array as it is shown."""

    pixels: Bytes
    """(h, w, 4) RGBA."""
    legend: str
    """What its colours stand for."""


def planes(arrays: Mapping[str, Any]) -> Iterator[tuple[str, NDArray[np.generic]]]:
    """What can be shown, (h, w) or (h, w, k), k <= 4: pages of an atlas, maps and light samples one by one."""
    for name, array in arrays.items():
        if isinstance(array, tuple):
            yield from ((f"{name}.{i}", page) for i, page in enumerate(array) if _is_plane(page))
        elif _is_plane(array):
            yield name, array
        elif array.ndim >= 3 and len(array) <= MOST_LAYERS:
            yield from ((f"{name}[{i}]", layer) for i, layer in enumerate(array) if _is_plane(layer))


def _is_plane(array: NDArray[np.generic]) -> bool:
    """Two dimensions of places, and up to four numbers each; no list of points."""
    if array.ndim == 2:
        return bool(array.shape[1] > 4)
    return array.ndim == 3 and array.shape[2] <= 4 and array.shape[1] > 1


def picture(name: str, array: NDArray[np.generic], contract: Mapping[str, StageArray]) -> Picture:
    """The picture of a plane, by what it holds."""
    if name == "color" or name.endswith(".albedo"):
        return Picture(opaque(np.asarray(array, np.float64)), "")
    values = np.asarray(array, np.float64)
    if values.ndim == 3 and values.shape[2] > 1:
        return _of_vectors(values[..., :3])
    values = values.reshape(values.shape[:2])
    shown = np.isfinite(values) & ~_nothing(name, values, contract)
    low, high = (float(values[shown].min()), float(values[shown].max())) if shown.any() else (0.0, 0.0)
    steps = np.zeros(values.shape, np.uint8)
    steps[shown] = np.rint(255.0 * (values[shown] - low) / (high - low or 1.0))
    pixels = np.full((*values.shape, 4), 255, np.uint8)
    pixels[..., :3] = np.where(shown[..., None], _RAMP[steps], _NOTHING)
    return Picture(pixels, f"violet {low:.6g} to yellow {high:.6g}; grey: nothing")


def opaque(color: NDArray[np.float64]) -> Bytes:
    """(h, w, 4) of linear colours (h, w, 3), as the conventions make bytes of them; what is no number is black."""
    pixels = np.full((*color.shape[:2], 4), 255, np.uint8)
    scaled = np.clip(color, 0.0, 1.0)
    np.multiply(scaled, 255.0, out=scaled)
    scaled += 0.5
    if np.isnan(scaled).any():
        np.nan_to_num(scaled, copy=False)
    pixels[..., :3] = scaled
    return pixels


def _of_vectors(values: NDArray[np.float64]) -> Picture:
    """Red, green and blue for x, y and z: of unit vectors from -1 to 1, of others from the least to the largest."""
    finite = np.isfinite(values).all(axis=-1)
    known = values[finite]
    pad = np.zeros((*values.shape[:2], 3))
    if not known.size:
        return Picture(opaque(pad), "nothing is there")
    units = bool(np.abs((known * known).sum(axis=-1) - 1.0).max() < 1e-6)
    low = np.full(known.shape[1], -1.0) if units else known.min(axis=0)
    high = np.full(known.shape[1], 1.0) if units else known.max(axis=0)
    pad[finite, : values.shape[2]] = (known - low) / np.where(high == low, 1.0, high - low)
    pixels = opaque(pad)
    pixels[~finite, :3] = _NOTHING
    ends = " | ".join(f"{a:.4g} to {b:.4g}" for a, b in zip(low.tolist(), high.tolist(), strict=True))
    return Picture(pixels, f"red | green | blue: {ends}; grey: nothing")


def _nothing(name: str, values: NDArray[np.float64], contract: Mapping[str, StageArray]) -> NDArray[np.bool_]:
    """Where an array holds its "nothing"; of one that no contract knows, nowhere."""
    try:
        blank = described(contract, name.partition("[")[0]).nothing
    except KeyError:
        blank = None
    if blank is None or isinstance(blank, (bool, tuple)):
        return np.zeros(values.shape, np.bool_)
    return np.asarray(values == float(blank))
