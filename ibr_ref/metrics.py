"""How far one picture is from another: the measures that reports, benches and reproductions print."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Picture(Protocol):
    """What has a picture: an `io.Frame`."""

    @property
    def color(self) -> NDArray[np.float64]:
        """(H, W, 3) in [0, 1]."""


def wrong(frame: Picture, truth: Picture, steps: float = 1.0) -> NDArray[np.bool_]:
    """(H, W) where a picture differs from the true one by more than `steps` of 1/255 in any channel.

    For two pictures of the reference, such as one of few steps and one of `method="exact"`; ports are judged by `oracle`.
    Raises ValueError for pictures of different sizes.
    """
    import numpy as np

    if frame.color.shape != truth.color.shape:
        sizes = [f"{color.shape[1]} x {color.shape[0]}" for color in (frame.color, truth.color)]
        raise ValueError(f"frame: found {sizes[0]} pixels, allowed: {sizes[1]} as in truth")
    return np.asarray((np.abs(frame.color - truth.color) * 255.0 > steps).any(axis=2))


def psnr(color: NDArray[np.float64], truth: NDArray[np.float64], where: NDArray[np.bool_]) -> float:
    """Peak signal-to-noise ratio of colours in [0, 1], over all channels of the pixels `where`, decibels."""
    error = float(((color - truth)[where] ** 2).mean()) if where.any() else 0.0
    return math.inf if error == 0.0 else -10.0 * math.log10(error)


def iou(ours: NDArray[np.float64], theirs: NDArray[np.float64]) -> float:
    """Intersection over union of where two arrays are >= 0.5; 1 where neither is anywhere."""
    a, b = ours >= 0.5, theirs >= 0.5
    union = int((a | b).sum())
    return float((a & b).sum()) / union if union else 1.0


def soft_difference(ours: NDArray[np.float64], theirs: NDArray[np.float64]) -> float:
    """Mean absolute difference of two shadows (H, W) where either is > 0; 0 where neither is."""
    import numpy as np

    where = (ours > 0.0) | (theirs > 0.0)
    return float(np.abs(ours - theirs)[where].mean()) if where.any() else 0.0
