"""The passes of splatting, in order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import Frame
from ibr_ref.pipeline.memory import arrays
from ibr_ref.pipeline.points import Splats, Target, draw_splats, target_for
from ibr_ref.scene import Light
from ibr_ref.splatting import atlas
from ibr_ref.splatting.buffers import Law, Lighting, Vertices, View, vertices_for
from ibr_ref.splatting.fragment import clear, resolve
from ibr_ref.splatting.inputs import Params, Scene
from ibr_ref.splatting.references import Prepared, prepare, view_of
from ibr_ref.splatting.vertex import color_vertices, place

BATCH_POINTS = 1 << 17
"""Points that are placed and drawn at a time, about: their arrays stay in the cache, and memory does not grow with them."""


def render(scene: Scene, params: Params | None = None, *, stages: bool = True) -> Frame:
    """Draw reference images with depth as splats.

    With `stages` the frame holds every intermediate array (`splatting.__doc__` lists them); without, the same picture
    and depth sooner, and in memory that does not grow with the number of points. Raises ValueError for an atlas that does
    not fit, and for a law whose denominator is not positive for a point in view.
    """
    params = Params() if params is None else params
    references = [prepare(image) for image in scene.images]
    rects = atlas.pack([reference.size for reference in references], params.max_atlas_size)
    view, law, lighting = view_of(scene.camera), _law(params), _lighting(scene.light)
    target = target_for(scene.camera.width, scene.camera.height, stages)
    starts = np.cumsum([0] + [reference.points for reference in references]).tolist()
    batches = list(_batches(references, starts))
    vertices = vertices_for(starts[-1] if stages else max(batch[-1].stop - batch[0].first for batch in batches))
    for batch in batches:
        base = batch[0].first if not stages else 0
        for rows in batch:
            block = _part(vertices, rows.first - base, rows.stop - base)
            if not place(references[rows.image].reference, view, law, rows.first_row, rows.last_row, block):
                raise ValueError(_unsound(params, rows))
        drawn = _part(vertices, batch[0].first - base, batch[-1].stop - base)
        draw_splats(Splats(*drawn), params.shape == "disc", batch[0].first, target)
    (color,) = arrays([(np.float64, (*target.splat.shape, 3))])
    clear(np.array(scene.background), color)
    for first, prepared in zip(starts, references, strict=False):
        resolve(prepared.reference, _normals(prepared, lighting), lighting, view, first, target.splat, color)
    frame = Frame(color=color, depth=target.depth, stages={})
    if stages:
        frame.stages.update(_atlas_stages(references, rects))
        frame.stages.update(_vertex_stages(references, starts, vertices, lighting, view))
        frame.stages.update(_raster_stages(target))
    return frame


def _law(params: Params) -> Law:
    return Law(params.alpha, params.beta, params.gamma, params.delta, params.min_width, params.max_width)


def _lighting(light: Light | None) -> Lighting:
    if light is None:
        return Lighting(False, np.zeros(4), np.zeros(3), 0)
    phong = np.array([light.ambient, light.diffuse, light.specular])
    return Lighting(True, light.homogeneous, phong, light.exponent)


def _normals(reference: Prepared, lighting: Lighting) -> NDArray[np.uint8]:
    """The 8-bit normals where there is a light to see them by."""
    return reference.normals if lighting.lit else np.empty((0, 3), np.uint8)


class Rows(NamedTuple):
    """A range of rows of a reference image, and the indices [first, stop) of its points."""

    image: int
    first_row: int
    last_row: int
    first: int
    stop: int


def _batches(references: Sequence[Prepared], starts: Sequence[int]) -> Iterator[list[Rows]]:
    """All points in order: rows of one image or several, with about BATCH_POINTS points together."""
    batch: list[Rows] = []
    for image, prepared in enumerate(references):
        row_starts, row = prepared.reference.row_starts, 0
        while row < len(row_starts) - 1:
            last = int(np.searchsorted(row_starts, row_starts[row] + BATCH_POINTS, side="right")) - 1
            last = max(last, row + 1)
            rows = Rows(image, row, last, starts[image] + int(row_starts[row]), starts[image] + int(row_starts[last]))
            if batch and rows.stop - batch[0].first > BATCH_POINTS:
                yield batch
                batch = []
            if rows.stop > rows.first:
                batch.append(rows)
            row = last
    yield batch


def _part(vertices: Vertices, first: int, stop: int) -> Vertices:
    return Vertices(*(array[first:stop] for array in vertices))


def _unsound(params: Params, rows: Rows) -> str:
    law = f"{params.beta:g} d^2 + {params.gamma:g} d + {params.delta:g}"
    return (
        f"beta, gamma, delta: found {law}, not positive for a point in view (images[{rows.image}], rows "
        f"{rows.first_row} to {rows.last_row - 1}), allowed: a law whose denominator is > 0 for every point in view"
    )


def _atlas_stages(references: Sequence[Prepared], rects: NDArray[np.int32]) -> dict[str, Any]:
    def pages(maps: Sequence[NDArray[np.generic]]) -> tuple[NDArray[np.generic], ...]:
        sizes = [reference.size for reference in references]
        return atlas.fill(rects, [m.reshape(h, w, *m.shape[1:]) for m, (w, h) in zip(maps, sizes, strict=True)])

    return {
        "atlas.rects": rects,
        "atlas.color": pages([_masked_color(reference) for reference in references]),
        "atlas.depth": pages([reference.reference.depth for reference in references]),
        "atlas.normal": pages([reference.normals for reference in references]),
    }


def _masked_color(reference: Prepared) -> NDArray[np.float64]:
    """The colours, 0 off the mask."""
    color, pixels = reference.reference.color, reference.reference.pixels
    if len(pixels) == len(color):
        return color
    masked = np.zeros_like(color)
    masked[pixels] = color[pixels]
    return masked


def _vertex_stages(
    references: Sequence[Prepared], starts: Sequence[int], vertices: Vertices, lighting: Lighting, view: View
) -> dict[str, Any]:
    colors, source = np.empty((starts[-1], 3)), np.empty((starts[-1], 3), np.int32)
    for i, reference in enumerate(references):
        part = slice(starts[i], starts[i + 1])
        color_vertices(reference.reference, _normals(reference, lighting), lighting, view, colors[part])
        source[part, 0] = i
        np.divmod(reference.reference.pixels, reference.reference.columns, out=(source[part, 1], source[part, 2]))
    return {
        "vertex.window": np.stack([vertices.x, vertices.y], axis=1),
        "vertex.depth": vertices.depth,
        "vertex.width": vertices.width,
        "vertex.color": colors,
        "vertex.source": source,
    }


def _raster_stages(target: Target) -> dict[str, Any]:
    return {
        "raster.splat": target.splat,
        "raster.depth": target.depth.copy(),
        "raster.overdraw": target.overdraw,
        "raster.margin": np.where(target.overdraw >= 2, target.second - target.depth, np.inf),
    }
