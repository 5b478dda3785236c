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
        lines += [f"maps and controls: {maps.nbytes:,} bytes", *placement_lines(params, maps)]
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


def placement_lines(params: Params, maps: Maps) -> list[str]:
    """How the control points were chosen, and what was expected of them."""
    placed = maps.choice
    if placed is None:
        return ["control points: simple or given ones, not compared with others"]
    chosen = placed.chosen
    lines = [
        f"control points: {chosen.name}; at {placed.places} other places IoU {chosen.mean:.3f} in the mean, "
        f"{chosen.worst:.3f} at worst",
        "not taken: " + ", ".join(f"{other.name} {other.mean:.3f} / {other.worst:.3f}" for other in placed.others),
    ]
    if placed.interpolation != params.interpolation:
        lines.append(f"they were chosen for interpolation {placed.interpolation}, not {params.interpolation}")
    return lines


def poor_line(maps: Maps) -> str | None:
    """What is said even without a report: that no control points serve this shadow well."""
    if maps.choice is None or maps.choice.good:
        return None
    chosen = maps.choice.chosen
    return (
        f"no good control points were found: with the best ({chosen.name}) maps are expected to have an IoU of "
        f"{chosen.mean:.2f} with rendered ones; a smaller range, larger maps or --map-samples may help"
    )


def soft_report_line(scene: Scene, frame: Frame) -> str:
    """A frame with stages that takes the whole light beside the one by rays."""
    from ibr_ref import shadows

    ours = frame.stages["soft.shadow" if "soft.shadow" in frame.stages else "accumulate.shadow"]
    theirs = shadows.render_soft(scene, shadows.SoftParams(method="traced")).stages["soft.shadow"]
    return (
        f"shadow in the picture against rays: IoU {iou(ours, theirs):.3f}, "
        f"mean difference {soft_difference(ours, theirs):.4f}"
    )
