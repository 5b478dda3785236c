"""`ibr-ref bench splatting`: the paper's points a second (tables 1 and 2)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ibr_ref.bench import splatting_quality
from ibr_ref.bench.times import best_and_median
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.scene import Camera, DepthImage
    from ibr_ref.splatting import Params

PAPER_MPPS = {
    "rig of 4": (25.19, 4.24, 0.66),
    "rig of 9": (25.74, 4.23, 0.65),
    "rig of 16": (25.44, 4.22, 0.66),
    "1 reference": (26.35, 4.25, 0.67),
    "4 references": (26.02, 4.23, 0.69),
    "8 references": (30.04, 4.87, 0.77),
}
"""Million points a second with shaders, fixed-function OpenGL and in software: tables 1 and 2, a GeForce 7800GTX."""

RIG_SIZES = {4: 210, 9: 189, 16: 201}
"""Pixels a side at which the references of the kettle have the paper's numbers of points, to 1 %."""


READS_MSR = True


def measured(repeat: int, msr: Path | None) -> Iterator[tuple[str, list[dict[str, Any]], Any]]:
    """What `ibr-ref bench` shows: name, rows and table of each measurement, one after the other."""
    rows = times(repeat, msr)
    yield "splatting", rows, table(rows)
    if msr is not None:
        rows = splatting_quality.views(msr)
        yield "splatting_quality", rows, splatting_quality.table(rows)


def times(repeat: int, msr: Path | None) -> list[dict[str, Any]]:
    """One row for each set of reference images; times in milliseconds, points a second in millions."""
    from ibr_ref import splatting

    rows = []
    with progress(len(RIG_SIZES) + 3) as step:
        for name, scene, params in scenes(msr):
            step(name)
            points = sum(int(image.arrays[2].sum()) for image in scene.images)
            row: dict[str, Any] = {"scene": name, "points": points}
            for key, stages in (("picture", False), ("stages", True)):
                best, median = best_and_median(lambda: splatting.render(scene, params, stages=stages), repeat)  # noqa: B023
                row |= {f"{key}_best_ms": best * 1e3, f"{key}_median_ms": median * 1e3}
                row[f"{key}_mpps"] = points / best / 1e6
            row["paper_mpps"] = PAPER_MPPS[name]
            rows.append(row)
    return rows


def scenes(msr: Path | None) -> Any:
    """Name, scene and parameters of every row: made one after the other, as the last ones are large."""
    from ibr_ref import models, splatting
    from ibr_ref.scene import Camera, Light

    kettle = models.kettle()
    view = Camera.look_at(eye=(1.9, -2.2, 1.9), target=(0.15, 0, 0.5), near=0.1, far=10.0)
    for count, size in RIG_SIZES.items():
        images = models.depth_rig(kettle, count, size=size)
        scene = splatting.Scene(images=images, camera=view, light=Light(direction=(-0.5, -0.8, 1.0), specular=0.3))
        yield f"rig of {count}", scene, _fitted(images, view)
    images, view = _large_pictures(msr)
    params = _fitted(images[:1], view)
    for count in (1, 4, 8):
        several = [images[i % len(images)] for i in range(count)]
        name = "1 reference" if count == 1 else f"{count} references"
        yield name, splatting.Scene(images=several, camera=view, light=None), params


def _fitted(images: list[DepthImage], view: Camera) -> Params:
    from ibr_ref import splatting

    return splatting.Params(**splatting.fit_splat_law(images, view)._asdict())


def _large_pictures(msr: Path | None) -> tuple[list[DepthImage], Camera]:
    """Two pictures of 1024 x 768 points, camera 0's and camera 1's, and the view, camera 1's."""
    from ibr_ref import io

    if msr is not None:
        first, second = io.read_msr(msr, cameras=(0, 1))
    else:
        first, second = _hills(-1.0), _hills(1.0)
    return [first, second], second.camera


def _hills(eye_x: float) -> DepthImage:
    """A wavy, chequered ground by formula, which fills the picture."""
    import numpy as np

    from ibr_ref.scene import Camera, DepthImage

    camera = Camera.look_at(
        eye=(eye_x, -8.0, 6.0), target=(eye_x, 0, 0), vertical_fov=30, near=1, far=60, width=1024, height=768
    )
    column, row = np.meshgrid(np.arange(1024) / 1023.0, np.arange(768) / 767.0)
    waves = (column * 6.0 % 1.0 - 0.5) ** 2 + (row * 5.0 % 1.0 - 0.5) ** 2
    depth = 14.0 - 7.0 * row + 0.6 * waves
    chequers = ((column * 32).astype(int) + (row * 24).astype(int)) % 2
    color = np.stack([0.3 + 0.5 * chequers, 0.8 - 0.5 * row, 0.3 + 0.4 * column], axis=2)
    return DepthImage(color=color, depth=depth, camera=camera)


def table(rows: list[dict[str, Any]]) -> Any:
    """The rows as a table for the terminal."""
    from rich.table import Table

    import ibr_ref
    from ibr_ref import jit

    result = Table(
        title="Splatting of depth images: milliseconds a frame, best (median), and million points a second",
        caption=f"ibr_ref {ibr_ref.__version__}, {jit.threads()} threads; paper: shaders / OpenGL / software on a GeForce "
        "7800GTX, tables 1 and 2",
    )
    columns = ("references", "points", "picture and depth", "Mpoints/s", "all stages", "Mpoints/s", "paper, Mpoints/s")
    for column in columns:
        result.add_column(column, justify="left" if column == "references" else "right")
    for row in rows:
        result.add_row(
            row["scene"],
            f"{row['points']:,}",
            f"{row['picture_best_ms']:.1f} ({row['picture_median_ms']:.1f})",
            f"{row['picture_mpps']:.1f}",
            f"{row['stages_best_ms']:.1f} ({row['stages_median_ms']:.1f})",
            f"{row['stages_mpps']:.1f}",
            " / ".join(f"{value:.2f}" for value in row["paper_mpps"]),
        )
    return result
