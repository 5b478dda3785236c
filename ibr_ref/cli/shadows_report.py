"""What `ibr-ref render shadows --report` says of a frame."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ibr_ref.metrics import iou, soft_difference

if TYPE_CHECKING:
    from ibr_ref.io import Frame
    from ibr_ref.shadows import Maps, Params, Scene


def report_lines(scene: Scene, params: Params, frame: Frame, maps: Maps | None) -> list[str]:
    """A frame with stages beside the one whose maps are rendered for every sample."""
    import numpy as np

    from ibr_ref import shadows

    lines = []
    if maps is not None:
        lines.append(f"maps and controls: {maps.nbytes:,} bytes")
        cut = shadows.cut_by_light(scene, params, of_maps=True)
        if cut.cut:
            lines.append(f"the light's frustum does not hold the caster at all nine places: {cut.words()}")
    truth = shadows.render(scene, replace(params, method="direct")).stages
    size = params.map_size
    found = [
        iou(a, b)
        for a, b in zip(
            np.reshape(frame.stages["warp.image"], (-1, size, size)),
            np.reshape(truth["warp.image"], (-1, size, size)),
            strict=True,
        )
    ]
    ours, theirs = frame.stages["accumulate.shadow"], truth["accumulate.shadow"]
    lines.append(f"maps against rendered ones: IoU {np.mean(found):.3f} in the mean, {min(found):.3f} at worst")
    lines.append(
        f"shadow in the picture: IoU {iou(ours, theirs):.3f}, mean difference {soft_difference(ours, theirs):.4f}"
    )
    return lines


def soft_report_line(scene: Scene, frame: Frame) -> str:
    """A frame of `render_soft` with stages beside the one by rays."""
    from ibr_ref import shadows

    ours = frame.stages["soft.shadow"]
    theirs = shadows.render_soft(scene, shadows.SoftParams(method="traced")).stages["soft.shadow"]
    return (
        f"shadow in the picture against rays: IoU {iou(ours, theirs):.3f}, "
        f"mean difference {soft_difference(ours, theirs):.4f}"
    )
