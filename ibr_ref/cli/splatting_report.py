"""What `ibr-ref render splatting --report` says of a view's quality."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ibr_ref.metrics import psnr

if TYPE_CHECKING:
    from ibr_ref.io import Frame
    from ibr_ref.scene import DepthImage
    from ibr_ref.splatting import Params, Scene


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
