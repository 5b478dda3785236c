"""What `ibr-ref render splatting --report` and `ibr-ref bench splatting --msr` say of a view's quality."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ibr_ref.io import Frame
    from ibr_ref.scene import DepthImage
    from ibr_ref.splatting import Params, Scene


def psnr(color: NDArray[np.float64], truth: NDArray[np.float64], where: NDArray[np.bool_]) -> float:
    """Peak signal-to-noise ratio of colours in [0, 1], over all channels of the pixels `where`, decibels."""
    error = float(((color - truth)[where] ** 2).mean()) if where.any() else 0.0
    return math.inf if error == 0.0 else -10.0 * math.log10(error)


def report_lines(scene: Scene, params: Params, frame: Frame, photograph: DepthImage | None) -> list[str]:
    """The law, coverage, holes and overdraw of a frame with stages, and how near it comes to the photograph."""
    from ibr_ref import splatting

    found = splatting.coverage(scene, frame)
    lines = [
        _size(params),
        f"coverage: {found.coverage:.4f} of the picture; overdraw: {found.mean_overdraw:.2f} splats a covered pixel",
        f"holes: {100 * found.hole_share:.2f} % of the pixels where the surface is known ({int(found.holes.sum())})",
    ]
    if photograph is not None:
        decibels = psnr(frame.color, photograph.arrays[0], found.covered)
        lines.append(f"against the photograph: {decibels:.2f} dB on the covered pixels (RGB)")
    return lines


def _size(params: Params) -> str:
    if params.shape == "ellipse":
        return (
            f"ellipses: deviations of {params.footprint:g} reference pixels and {params.low_pass:g} pixels, out to "
            f"{params.cutoff:g} of them; averaged within {100 * params.depth_tolerance:g} % of the distance"
        )
    law = f"{params.alpha:g} / ({params.beta:g} d^2 + {params.gamma:g} d + {params.delta:g})"
    return f"width: {law} pixels, from {params.min_width:g} to {params.max_width:g}"
