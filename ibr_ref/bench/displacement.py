"""`ibr-ref bench displacement`: the paper's frame rates (section 5)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ibr_ref.bench import gathers
from ibr_ref.bench.times import best_and_median
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.displacement import Params, Scene

PAPER_FPS = {("box", 640, 10): 60, ("box", 640, 50): 25, ("box", 1000, 10): 30, ("box", 1000, 50): 10}
"""Frames a second of the paper's GeForce 6600GT (section 5), by scene, picture width and N."""


def _scenes() -> list[tuple[str, Scene, Params]]:
    """Scene name, scene and parameters of every row."""
    from ibr_ref import displacement, models
    from ibr_ref.scene import Camera, Light

    light = Light(direction=(0.5, -0.8, 1.0))
    views: list[tuple[str, Any, tuple[float, float, float]]] = [
        ("box", (models.box(),), (0.75, -0.95, 0.75)),
        ("city", (models.city(),), (2.6, -3.2, 2.0)),
        ("city 4 x 4", models.city_blocks(), (2.6, -3.2, 2.0)),
    ]
    result = []
    for name, polygons, eye in views:
        for width, height in ((640, 480), (1000, 1000)):
            camera = Camera.look_at(eye=eye, target=(0, 0, 0), near=0.1, far=20.0, width=width, height=height)
            scene = displacement.Scene(polygons=polygons, camera=camera, light=light)
            for steps in (10, 50):
                result.append((name, scene, displacement.Params(linear_steps=steps)))
    return result


READS_MSR = False


def measured(repeat: int, msr: Path | None) -> Iterator[tuple[str, list[dict[str, Any]], Any]]:
    """What `ibr-ref bench` shows: name, rows and table of each measurement, one after the other."""
    rows = times(repeat)
    yield "displacement", rows, table(rows)


def times(repeat: int) -> list[dict[str, Any]]:
    """One row for each scene, picture size and N."""
    from ibr_ref import displacement

    scenes = _scenes()
    rows = []
    with progress(len(scenes)) as step:
        for name, scene, params in scenes:
            width, height = scene.camera.width, scene.camera.height
            step(f"{name}, {width} x {height}, N = {params.linear_steps}")
            row: dict[str, Any] = {"scene": name, "width": width, "height": height, "linear_steps": params.linear_steps}
            for key, stages in (("picture", False), ("stages", True)):
                best, median = best_and_median(lambda: displacement.render(scene, params, stages=stages), repeat)  # noqa: B023
                row[f"{key}_best_ms"], row[f"{key}_median_ms"] = best * 1e3, median * 1e3
            fps = PAPER_FPS.get((name, width, params.linear_steps))
            row |= gathers.beside(scene, params, row["picture_best_ms"] / 1e3)
            row["paper_ms"] = None if fps is None else 1000.0 / fps
            rows.append(row)
    return rows


def table(rows: list[dict[str, Any]]) -> Any:
    """The rows as a table for the terminal."""
    from rich.table import Table

    import ibr_ref
    from ibr_ref import jit

    table = Table(
        title="Protruded displacement mapping, M = 6: milliseconds a frame, best (median)",
        caption=f"ibr_ref {ibr_ref.__version__}, {jit.threads()} threads; paper: GeForce 6600GT, section 5; gathers: "
        "texels that the method asks for, at the rate of gathers alone from a map of this size",
    )
    for column in (
        "scene",
        "picture",
        "N",
        "picture and depth",
        "gathers at their limit",
        "beside it",
        "all stages",
        "paper",
    ):
        table.add_column(column, justify="left" if column == "scene" else "right")
    for row in rows:
        table.add_row(
            row["scene"],
            f"{row['width']} x {row['height']}",
            str(row["linear_steps"]),
            f"{row['picture_best_ms']:.1f} ({row['picture_median_ms']:.1f})",
            f"{1e-6 * row['gathers']:.1f} M, {row['gathers_ms']:.1f}",
            f"{row['beside_gathers']:.2f}x",
            f"{row['stages_best_ms']:.1f} ({row['stages_median_ms']:.1f})",
            "" if row["paper_ms"] is None else f"{row['paper_ms']:.1f}",
        )
    return table
