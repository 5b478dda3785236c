"""`ibr-ref bench shadows`: the paper's tables 1 to 5."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ibr_ref.bench.times import best_and_median
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.scene import Mesh
    from ibr_ref.shadows import MapGrid, Maps, Params, Scene

SIZES = (64, 128, 256, 512)

PAPER_WARP = {"kettle": (4, 5, 8, 13), "chair": (5, 6, 8, 13), "horse": (5, 6, 9, 14)}
"""Table 1: one warped shadow, milliseconds at each size; the horse stands for the cow, which has as many polygons."""
PAPER_FRAME = {"kettle": (12, 14, 19, 55), "chair": (15, 18, 25, 59), "horse": (23, 29, 31, 68)}
"""Table 1: the whole frame."""
PAPER_KETTLE = {
    "direct": (22, 48, 87, 204),
    "warp 5 x 15": (4, 5, 8, 13),
    "warp 7 x 15": (4, 5, 8, 15),
    "warp 5 x 15, 5 samples": (19, 21, 38, 79),
    "warp 7 x 15, 5 samples": (20, 21, 40, 80),
    "warp 5 x 15, 9 samples": (33, 40, 58, 142),
    "warp 7 x 15, 9 samples": (33, 41, 60, 140),
    "direct, 5 samples": (161, 204, 472, 1075),
    "direct, 9 samples": (198, 483, 774, 1936),
    "grid, raw": (4, 6, 6, 30),
    "grid, compressed": (5, 8, 11, 25),
}
"""Tables 2 to 5: the teapot's shadow alone, milliseconds at each size, on a processor and card of 2001."""


READS_MSR = False


def measured(repeat: int, msr: Path | None) -> Iterator[tuple[str, list[dict[str, Any]], Any]]:
    """What `ibr-ref bench` shows: name, rows and table of each measurement, one after the other."""
    rows = times(repeat)
    yield "shadows", rows, table(rows)


def times(repeat: int) -> list[dict[str, Any]]:
    """One row for each way to make the shadow of an object, at each size of the maps: milliseconds and bytes."""
    meshes = objects()
    rows = []
    with progress(len(SIZES) * (len(meshes) + 3)) as step:
        for size in SIZES:
            for name, mesh in meshes.items():
                step(f"{name}, {size} x {size}")
                rows += of_object(name, mesh, size, repeat)
            for what, of_kettle in (("by other ways", by_samples), ("from a grid", from_grids), ("softened", softened)):
                step(f"kettle {what}, {size} x {size}")
                rows += of_kettle(meshes["kettle"], size, repeat)
    return rows


def objects() -> dict[str, Mesh]:
    """Meshes with as many triangles as the paper's objects have polygons: its teapot, chair and cow."""
    from ibr_ref import models

    return {"kettle": models.kettle(), "chair": models.chair(), "horse": models.horse()}


def stage(mesh: Mesh) -> Scene:
    """The object between the nine places that maps are made for."""
    from ibr_ref import models

    return models.shadow_stage(mesh, offset=(0.23, -0.31))


def of_object(name: str, mesh: Mesh, size: int, repeat: int) -> list[dict[str, Any]]:
    """Table 1: a warped shadow and the whole frame, whatever the object's complexity."""
    from ibr_ref import shadows

    i = SIZES.index(size)
    scene, params = stage(mesh), shadows.Params(map_size=size)
    maps = shadows.prepare(scene, params)
    frame = best_and_median(lambda: shadows.render(scene, params, maps=maps, stages=False), repeat)
    return [
        row(name, "warp, dissolve", size, map_times(scene, params, maps, repeat), PAPER_WARP[name][i], maps.nbytes),
        row(name, "warp, nearest", size, map_times(scene, replace(params, policy="nearest"), maps, repeat), None),
        row(name, "direct", size, map_times(scene, replace(params, method="direct"), None, repeat), None),
        row(name, "frame (warp, dissolve)", size, frame, PAPER_FRAME[name][i]),
    ]


def by_samples(mesh: Mesh, size: int, repeat: int) -> list[dict[str, Any]]:
    """Tables 2, 3 and 5: grids of control points, light samples, rendered maps."""
    from ibr_ref import shadows

    i, scene, plain = SIZES.index(size), stage(mesh), shadows.Params(map_size=size)
    rows = []
    for columns in (5, 7):
        wide = replace(plain, columns=columns, light_samples=9)
        maps = shadows.prepare(scene, wide)  # for nine samples, and so for fewer
        for count in (1, 5, 9):
            way = f"warp {columns} x 15" + (f", {count} samples" if count > 1 else "")
            seconds = map_times(scene, replace(wide, light_samples=count), maps, repeat)
            rows.append(row("kettle", way, size, seconds, PAPER_KETTLE[way][i], maps.nbytes))
    for count in (1, 5, 9):
        way = "direct" + (f", {count} samples" if count > 1 else "")
        params = replace(plain, method="direct", light_samples=count)
        rows.append(row("kettle", way, size, map_times(scene, params, None, repeat), PAPER_KETTLE[way][i]))
    return rows


def from_grids(mesh: Mesh, size: int, repeat: int) -> list[dict[str, Any]]:
    """Table 4: 32 x 32 maps made beforehand."""
    from ibr_ref import shadows

    i, scene, plain = SIZES.index(size), stage(mesh), shadows.Params(map_size=size, method="grid")
    rows = []
    for way, storage in {"grid, raw": "raw", "grid, compressed": "haar"}.items():
        params = replace(plain, grid_storage=storage)
        grid = shadows.prepare_grid(scene, params)
        rows.append(row("kettle", way, size, map_times(scene, params, grid, repeat), PAPER_KETTLE[way][i], grid.nbytes))
    return rows


def softened(mesh: Mesh, size: int, repeat: int) -> list[dict[str, Any]]:
    """Whole frames with a soft shadow: nine samples, rendered and warped, beside one map softened."""
    from ibr_ref import shadows

    scene, nine = stage(mesh), shadows.Params(map_size=size, light_samples=9)
    maps = shadows.prepare(scene, nine)
    direct = replace(nine, method="direct")
    frames: dict[str, Callable[[], object]] = {
        "direct, 9 samples": lambda: shadows.render(scene, direct, stages=False),
        "warp, 9 samples": lambda: shadows.render(scene, nine, maps=maps, stages=False),
    }
    convolved = shadows.SoftParams(method="convolution", map_size=size)
    frames["convolution"] = partial(shadows.render_soft, scene, convolved, stages=False)
    frames["pcss"] = partial(shadows.render, scene, shadows.Params(method="pcss", map_size=size), stages=False)
    return [
        row("kettle", f"frame ({way})", size, best_and_median(frame, repeat), None) for way, frame in frames.items()
    ]


def map_times(scene: Scene, params: Params, maps: Maps | MapGrid | None, repeat: int) -> tuple[float, float]:
    """Seconds for the map, or for one of each light sample: best and median."""
    from ibr_ref import shadows

    return best_and_median(lambda: shadows.shadow_maps(scene, params, maps=maps), repeat)


def row(
    name: str, way: str, size: int, seconds: tuple[float, float], paper: int | None, nbytes: int | None = None
) -> dict[str, Any]:
    """A line of the bench; paper: milliseconds."""
    best, median = (1e3 * s for s in seconds)
    return {
        "object": name,
        "way": way,
        "map_size": size,
        "best_ms": best,
        "median_ms": median,
        "paper_ms": paper,
        "bytes": nbytes,
    }


def table(rows: list[dict[str, Any]]) -> Any:
    """The rows as a table for the terminal: one line for each way, one column for each size."""
    from rich.table import Table

    import ibr_ref
    from ibr_ref import jit

    result = Table(
        title="Shadows: milliseconds for the shadow map(s), best (median) / paper",
        caption=f"ibr_ref {ibr_ref.__version__}, {jit.threads()} threads; warps with 5 x 15 control points and dissolve if "
        "nothing else is said; paper: tables 1 to 5, its cow beside our horse; memory at the largest size",
    )
    result.add_column("object")
    result.add_column("way")
    for size in SIZES:
        result.add_column(f"{size} x {size}", justify="right")
    result.add_column("memory, MB", justify="right")
    for name, way in dict.fromkeys((row["object"], row["way"]) for row in rows):
        line = [row for row in rows if (row["object"], row["way"]) == (name, way)]
        held = line[-1]["bytes"]
        result.add_row(name, way, *map(_cell, line), "" if held is None else f"{held / 2**20:.2f}")
    return result


def _cell(row: dict[str, Any]) -> str:
    paper = "" if row["paper_ms"] is None else f" / {row['paper_ms']}"
    return f"{row['best_ms']:.1f} ({row['median_ms']:.1f}){paper}"
