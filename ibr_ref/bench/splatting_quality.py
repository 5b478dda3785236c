"""`ibr-ref bench splatting --msr`: how good the views of real photographs are (the figures that the README names)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ibr_ref.metrics import psnr
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ibr_ref.scene import Camera, DepthImage


def views(msr: Path) -> list[dict[str, Any]]:
    """A row for each view of cameras 0 and 1, and how far camera 0's points stand before camera 1's own picture."""
    from ibr_ref import io
    from ibr_ref.scene import Camera

    first, second = io.read_msr(msr, cameras=(0, 1))
    between = Camera.between(first.camera, second.camera, 0.5)
    wanted: list[tuple[str, Sequence[DepthImage], Camera, DepthImage | None, bool]] = [
        ("camera 1 from 0, width 1", (first,), second.camera, second, False),
        ("camera 1 from 0, fitted", (first,), second.camera, second, True),
        ("midway from 0, fitted", (first,), between, None, True),
        ("midway from 1, fitted", (second,), between, None, True),
        ("midway from 0 and 1, fitted", (first, second), between, None, True),
        ("camera 1 from 0 and 1, width 1", (first, second), second.camera, second, False),
    ]
    rows = []
    with progress(len(wanted)) as step:
        for name, images, camera, photograph, fitted in wanted:
            step(name)
            rows.append({"view": name} | _quality(images, camera, photograph, fitted))
    return rows


def _quality(
    images: Sequence[DepthImage], camera: Camera, photograph: DepthImage | None, fitted: bool
) -> dict[str, Any]:
    from ibr_ref import splatting

    scene = splatting.Scene(images=images, camera=camera, light=None)
    law = splatting.fit_splat_law(images, camera)._asdict() if fitted else {}
    frame = splatting.render(scene, splatting.Params(**law))
    found = splatting.coverage(scene, frame)
    row: dict[str, Any] = {
        "coverage": found.coverage,
        "holes": found.hole_share,
        "overdraw": found.mean_overdraw,
        "psnr": None if photograph is None else psnr(frame.color, photograph.arrays[0], found.covered),
    }
    if photograph is not None and len(images) == 2:
        row |= _intruders(frame, photograph)
    return row


def _intruders(frame: Any, own: DepthImage) -> dict[str, float]:
    """Pixels of camera 1's own picture that a point of camera 0 wins, and by how much it stands before camera 1's."""
    import numpy as np

    splat, camera = frame.stages["raster.splat"], own.camera
    image = frame.stages["vertex.source"][:, 0]
    won = (splat >= 0) & (image[np.maximum(splat, 0)] == 0)
    z = camera.clip_from_view[2]
    theirs = z[3] / (frame.depth[won] + z[2])  # metric depth from the window's: (z[2] (-d) + z[3])/d = window depth
    lead = (own.arrays[1][won] - theirs) / own.arrays[1][won]
    return {
        "won_by_0": float(won.mean()),
        "median_lead": float(np.median(lead)),
        "lead_below_2_percent": float((lead < 0.02).mean()),
    }


def table(rows: list[dict[str, Any]]) -> Any:
    """The rows as a table for the terminal."""
    from rich.table import Table

    result = Table(title="Views of the photographs")
    for column in ("view", "coverage", "holes, %", "overdraw", "dB (RGB, covered)"):
        result.add_column(column, justify="left" if column == "view" else "right")
    for row in rows:
        result.add_row(
            row["view"],
            f"{row['coverage']:.4f}",
            f"{100 * row['holes']:.2f}",
            f"{row['overdraw']:.2f}",
            "" if row["psnr"] is None else f"{row['psnr']:.2f}",
        )
        if "won_by_0" in row:
            result.caption = (
                f"With both, camera 0 wins {100 * row['won_by_0']:.1f} % of the pixels of camera 1's own picture: their "
                "depth codes stand for the same planes of the world, so that points of one surface all but tie, and the "
                f"nearer wins. Camera 0's stand {100 * row['median_lead']:.4f} % of the depth before camera 1's own in the "
                f"median, {100 * row['lead_below_2_percent']:.1f} % of them less than 2 %; a step of the code is 0.5 %."
            )
    return result
