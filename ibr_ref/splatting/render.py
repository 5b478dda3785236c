"""The passes of splatting, in order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import Frame
from ibr_ref.pipeline.ellipses import Blend, Ellipses, accumulate, blend_for, draw_nearest, normalize
from ibr_ref.pipeline.memory import arrays
from ibr_ref.pipeline.points import Splats, Target, draw_splats, target_for
from ibr_ref.scene import checks
from ibr_ref.splatting import atlas
from ibr_ref.splatting.batches import Rows, batches, starts_of
from ibr_ref.splatting.buffers import Law, Lighting, Vertices, View, vertices_for
from ibr_ref.splatting.footprint import Filter, ellipses_for, footprints
from ibr_ref.splatting.fragment import clear, occupied, resolve
from ibr_ref.splatting.inputs import Params, Scene
from ibr_ref.splatting.references import Prepared, lighting_of, prepare, view_of
from ibr_ref.splatting.software import draw_all
from ibr_ref.splatting.vertex import color_vertices, place


class Pass(NamedTuple):
    """A frame that is being drawn: what each of the three ways to draw it needs, and is to fill in."""

    references: Sequence[Prepared]
    view: View
    lighting: Lighting
    background: NDArray[np.float64]
    params: Params
    stages: bool
    rows: tuple[int, int]
    """First and one past the last that are drawn."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of what is drawn, pixels."""
        return int(self.view.width), self.rows[1] - self.rows[0]


class Drawn(NamedTuple):
    """What they return."""

    color: NDArray[np.float64]
    depth: NDArray[np.float64]
    vertices: Vertices
    """Of all points; without stages those that were left of the last batch."""
    stages: dict[str, Any]
    """Those of stage raster, and of ellipses."""


def render(
    scene: Scene, params: Params | None = None, *, stages: bool = True, rows: tuple[int, int] | None = None
) -> Frame:
    """Draw reference images with depth as splats.

    With `stages` the frame holds every intermediate array (`contract.STAGES` lists them); without, the same picture
    and depth sooner, and in memory that does not grow with the number of points. rows: first and one past the last row of
    the picture that are drawn, the same bits as in all of it; None: all. Raises ValueError for an atlas that does not fit,
    and for a law whose denominator is not positive for a point in view.
    """
    params = Params() if params is None else params
    references = [prepare(image) for image in scene.images]
    rects = atlas.pack([reference.size for reference in references], params.max_atlas_size)
    view, lighting, background = view_of(scene.camera), lighting_of(scene.light), np.array(scene.background)
    ways = {"software": _loop, "shader": _weighted if params.shape == "ellipse" else _nearest}
    drawn = ways[params.method](
        Pass(references, view, lighting, background, params, stages, checks.rows(rows, scene.camera.height))
    )
    frame = Frame(color=drawn.color, depth=drawn.depth, stages={})
    if stages:
        frame.stages.update(_atlas_stages(references, rects))
        frame.stages.update(_vertex_stages(references, drawn.vertices, lighting, view))
        frame.stages.update(drawn.stages)
    return frame


def _nearest(work: Pass) -> Drawn:
    """The paper's: squares or discs through the depth test, then the winners' colours."""
    target = target_for(*work.size, work.stages, work.rows[0])
    parts = list(batches(work.references))
    vertices = _room(work, parts)
    for batch in parts:
        drawn = _placed(work, batch, vertices)
        draw_splats(Splats(*drawn), work.params.shape == "disc", batch[0].first, target)
    (color,) = arrays([(np.float64, (*target.splat.shape, 3))])
    clear(work.background, color)
    spans = occupied(target.splat)
    for first, prepared in zip(starts_of(work.references), work.references, strict=False):
        normals = _normals(prepared, work.lighting)
        resolve(prepared.reference, normals, work.lighting, work.view, first, target.splat, spans, color)
    return Drawn(color, target.depth, vertices, _raster_stages(target) if work.stages else {})


def _weighted(work: Pass) -> Drawn:
    """Elliptical weighted averages: the nearest splats, then those of the same surface added up."""
    target, params = blend_for(*work.size, work.stages, work.rows[0]), work.params
    parts = list(batches(work.references))
    vertices = _room(work, parts)
    ellipses = ellipses_for(vertices)
    for batch in parts:
        draw_nearest(_shaped(work, batch, vertices, ellipses), params.cutoff, batch[0].first, target)
    for batch in parts:
        drawn = _shaped(work, batch, vertices, ellipses)
        accumulate(drawn, _colored(work, batch), params.cutoff, params.depth_tolerance, target)
    normalize(work.background, target.weight, target.color)
    return Drawn(target.color, target.depth, vertices, _blend_stages(ellipses, target) if work.stages else {})


def _loop(work: Pass) -> Drawn:
    """The loop in software, point by point."""
    starts, target = starts_of(work.references), target_for(*work.size, work.stages, work.rows[0])
    color, vertices = np.empty((*target.splat.shape, 3)), vertices_for(starts[-1] if work.stages else 0)
    clear(work.background, color)
    disc, law, lighting = work.params.shape == "disc", _law(work.params), work.lighting
    for image, prepared in enumerate(work.references):
        here = _part(vertices, *starts[image : image + 2])
        normals = _normals(prepared, lighting)
        row = draw_all(prepared.reference, normals, work.view, law, lighting, disc, starts[image], here, target, color)
        if row >= 0:
            raise ValueError(_unsound(work.params, Rows(image, row, row + 1, 0, 0)))
    return Drawn(color, target.depth, vertices, _raster_stages(target) if work.stages else {})


def _room(work: Pass, parts: Sequence[Sequence[Rows]]) -> Vertices:
    """Vertices for all points, or without stages for the largest batch."""
    sizes = [batch[-1].stop - batch[0].first for batch in parts]
    return vertices_for(sum(sizes) if work.stages else max(sizes))


def _base(work: Pass, batch: Sequence[Rows]) -> int:
    """Index of the point that has the first of the vertices."""
    return 0 if work.stages else batch[0].first


def _placed(work: Pass, batch: Sequence[Rows], vertices: Vertices) -> Vertices:
    """A batch's points in the window."""
    base, law = _base(work, batch), _law(work.params)
    for rows in batch:
        block = _part(vertices, rows.first - base, rows.stop - base)
        reference = work.references[rows.image].reference
        if not place(reference, work.view, law, rows.first_row, rows.last_row, block):
            raise ValueError(_unsound(work.params, rows))
    return _part(vertices, batch[0].first - base, batch[-1].stop - base)


def _shaped(work: Pass, batch: Sequence[Rows], vertices: Vertices, ellipses: Ellipses) -> Ellipses:
    """A batch's points in the window, with their ellipses."""
    _placed(work, batch, vertices)
    base, p = _base(work, batch), work.params
    filters = Filter(p.footprint, p.low_pass, p.cutoff, p.max_width)
    for rows in batch:
        prepared, here = work.references[rows.image], slice(rows.first - base, rows.stop - base)
        footprints(
            prepared.reference, prepared.normals, work.view, filters, rows.first_row, rows.last_row,
            Vertices(*(array[here] for array in vertices)), Ellipses(*(array[here] for array in ellipses)),
        )  # fmt: skip
    drawn = slice(batch[0].first - base, batch[-1].stop - base)
    return Ellipses(*(array[drawn] for array in ellipses))


def _colored(work: Pass, batch: Sequence[Rows]) -> NDArray[np.float64]:
    """(n, 3) the colours of a batch's points."""
    (colors,) = arrays([(np.float64, (batch[-1].stop - batch[0].first, 3))])
    for rows in batch:
        prepared = work.references[rows.image]
        here = colors[rows.first - batch[0].first : rows.stop - batch[0].first]
        normals = _normals(prepared, work.lighting)
        color_vertices(prepared.reference, normals, work.lighting, work.view, rows.first_row, rows.last_row, here)
    return colors


def _law(params: Params) -> Law:
    """The law; ellipses do not ask for it, and so none can be wrong."""
    if params.shape == "ellipse":
        return Law(1.0, 0.0, 0.0, 1.0, 1.0, 1.0)
    return Law(params.alpha, params.beta, params.gamma, params.delta, params.min_width, params.max_width)


def _normals(reference: Prepared, lighting: Lighting) -> NDArray[np.uint8]:
    """The 8-bit normals where there is a light to see them by."""
    return reference.normals if lighting.lit else np.empty((0, 3), np.uint8)


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
    references: Sequence[Prepared], vertices: Vertices, lighting: Lighting, view: View
) -> dict[str, Any]:
    starts = starts_of(references)
    colors, source = np.empty((starts[-1], 3)), np.empty((starts[-1], 3), np.int32)
    for i, reference in enumerate(references):
        part = slice(starts[i], starts[i + 1])
        rows = len(reference.reference.row_starts) - 1
        color_vertices(reference.reference, _normals(reference, lighting), lighting, view, 0, rows, colors[part])
        source[part, 0] = i
        np.divmod(reference.reference.pixels, reference.reference.columns, out=(source[part, 1], source[part, 2]))
    return {
        "vertex.window": np.stack([vertices.x, vertices.y], axis=1),
        "vertex.depth": vertices.depth,
        "vertex.width": vertices.width,
        "vertex.color": colors,
        "vertex.source": source,
    }


def _raster_stages(target: Target | Blend) -> dict[str, Any]:
    return {
        "raster.splat": target.splat,
        "raster.depth": target.depth.copy(),
        "raster.overdraw": target.overdraw,
        "raster.margin": np.where(target.overdraw >= 2, target.second - target.depth, np.inf),
    }


def _blend_stages(ellipses: Ellipses, target: Blend) -> dict[str, Any]:
    """What ellipses have beside the stages of all splats; NaN for a dropped point."""
    covariance = np.stack([ellipses.xx, ellipses.xy, ellipses.yy], axis=1)
    dropped = np.isnan(ellipses.x)
    covariance[dropped] = np.nan
    return {
        "vertex.covariance": covariance,
        "vertex.amplitude": np.where(dropped, np.nan, ellipses.amplitude),
        "vertex.distance": np.where(dropped, np.nan, ellipses.distance),
        **_raster_stages(target),
        "raster.weight": target.weight,
        "raster.blended": target.blended,
    }
