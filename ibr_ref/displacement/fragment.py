"""Fragment stage: a draw call of one base polygon, from triangles to pixels.

The picture is drawn in bands of rows: all stages run over one band before the next, so that the arrays between them
stay in the cache; bands run in parallel, and each pixel belongs to one of them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Floats, Indices, Wrap
from ibr_ref.displacement.buffers import (
    Fragments,
    Hits,
    Settings,
    Shades,
    Uniforms,
    fragments_for,
    hits_for,
    rays_for,
    shades_for,
)
from ibr_ref.displacement.exact import exact_search
from ibr_ref.displacement.march import binary_search, heights_before, linear_search, mark_steep, place_hits
from ibr_ref.displacement.margins import binary_margins, linear_border, linear_margins
from ibr_ref.displacement.maxima import Maxima
from ibr_ref.displacement.raster import count_fragments, rasterize, take_fragments, take_hits
from ibr_ref.displacement.rays import paper_rays, volume_rays
from ibr_ref.displacement.relief import relief_search, texture_search
from ibr_ref.displacement.resolve import (
    Target,
    clear,
    depth_test,
    noted_depth_test,
    project_hits,
    write_color,
    write_shades,
    write_stages,
)
from ibr_ref.displacement.self_shadow import self_shadow
from ibr_ref.displacement.shade import albedos, facades, height_normals, light_hits, mapped_normals, slopes
from ibr_ref.displacement.textures import Map, Maps
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.bands import stride_of
from ibr_ref.pipeline.triangles import Triangles

BUILT_IN = ("protruded", "exact", "relief", "texture")
"""Searches that this kernel has; the hits of others are found before (`compared`)."""
PROTRUDED, EXACT, RELIEF, TEXTURE = range(4)

_BAND_PIXELS = 4096
"""Of a band, about: its arrays then take half a megabyte."""


def rows_of_a_band(width: int) -> int:
    """Of a picture of so many columns."""
    return max(1, _BAND_PIXELS // width)


@device
def search(
    repeat: Wrap, keep: bool | None, fragments: Fragments, count: int, constants: Uniforms, settings: Settings,
    maps: Maps, hits: Hits,
) -> None:  # fmt: skip
    """Stage march: the hits of all fragments, by the method's search."""
    texels, columns, rows = maps.height
    if settings.method == TEXTURE:
        texture_search(fragments, count, settings, hits)
        return
    if settings.method == RELIEF:
        relief_search(repeat, fragments, count, constants.eye, texels, columns, rows, settings, hits)
        return
    rays = rays_for(count)
    if settings.volume:
        volume_rays(fragments, count, constants.eye, rays)
    else:
        paper_rays(fragments, count, constants.eye, rays)
    if settings.method == EXACT:
        exact_search(repeat, fragments, rays, count, texels, columns, rows, maps.maxima.everywhere, settings, hits)
        return
    linear, index = hits.linear_index, hits.hit_index
    linear_search(repeat, rays, count, texels, columns, rows, maps.maxima, settings, linear)
    binary_search(repeat, rays, count, texels, columns, rows, settings, linear, index)
    if keep is not None or maps.facade.texels.size > 0:
        heights_before(repeat, rays, count, texels, columns, rows, settings, linear, hits.height_before)
    if keep is not None:
        if settings.bounded:
            linear_border(rays, count, settings, linear, hits.domain_margin)
        binary_margins(
            repeat, rays, count, texels, columns, rows, settings, linear, index, hits.margin, hits.domain_margin
        )
        linear_margins(repeat, rays, count, texels, columns, rows, maps.maxima, settings, linear, hits.margin)
    place_hits(fragments, rays, count, settings, hits)


@device
def shade(
    repeat: Wrap, keep: bool | None, hits: Hits, count: int, constants: Uniforms, settings: Settings, maps: Maps,
    shades: Shades,
) -> None:  # fmt: skip
    """Stage shade: colours of all hits."""
    texels, columns, rows = maps.height
    has_normals, has_facade = maps.normal.texels.size > 0, maps.facade.texels.size > 0
    if has_facade or not has_normals:
        slopes(repeat, hits, count, texels, columns, rows, shades.slope)
    if has_normals:
        mapped_normals(
            repeat, hits, count, maps.normal.texels, maps.normal.columns, maps.normal.rows, constants, shades.normal
        )
    else:
        height_normals(hits, count, constants, shades.slope, shades.normal)
    albedos(repeat, hits, count, maps.color.texels, maps.color.columns, maps.color.rows, shades.albedo)
    if has_facade:
        facades(hits, count, maps.facade.texels, maps.facade.columns, maps.facade.rows, constants, shades)
    if settings.shadow_steps > 0:
        self_shadow(repeat, keep, hits, count, texels, columns, rows, constants.light, settings, shades)
    light_hits(hits, count, constants, shades)


@device
def _draw_band(
    repeat: Wrap, keep: bool | None, covered: Any, bands: Any, found: Any, band: int,
    triangles: Triangles, faces: Indices, constants: Uniforms, settings: Settings, maps: Maps, patch_id: int, width: int,
    first_row: int, last_row: int, target: Target,
) -> None:  # fmt: skip
    if found is None:
        count = count_fragments(triangles, width, first_row, last_row)
    else:
        count = bands[band, 1]
    if count == 0:
        return
    fragments, hits, shades = fragments_for(count), hits_for(count), shades_for(count)
    verdicts = np.empty(count, np.int8)
    if found is None:
        rasterize(triangles, faces, width, first_row, last_row, settings.polygon_depth, fragments, 0)
        search(repeat, keep, fragments, count, constants, settings, maps, hits)
    else:
        take_fragments(covered, bands[band, 0], count, fragments)
        take_hits(found, bands[band, 0], count, hits)
    project_hits(fragments, count, constants, settings, hits)
    if settings.method == PROTRUDED or settings.method == EXACT:
        mark_steep(count, settings, hits)
    if keep is not None:
        shown = noted_depth_test(fragments, hits, count, target, verdicts)
    else:
        shown = depth_test(fragments, hits, count, target, verdicts)
    if shown > 0 or keep is not None:
        shade(repeat, keep, hits, count, constants, settings, maps, shades)
    write_color(fragments, shades, count, verdicts, target)
    if keep is not None:
        write_stages(fragments, hits, count, patch_id, verdicts, target)
        write_shades(fragments, hits, shades, count, verdicts, target)


@kernel
def draw(
    repeat: Wrap, keep: bool | None, covered: Any, bands: Any, found: Any,
    triangles: Triangles, faces: Indices, constants: Uniforms, settings: Settings,
    heights: Map, colors: Map, normals: Map, facade: Map, maxima: Maxima,
    patch_id: int, width: int, height: int, band_rows: int, background: Floats, target: Target,
) -> None:  # fmt: skip
    """Draw one polygon into the target: patch_id 0 clears it first, band by band; others come over what is there.

    repeat: the wrap mode of its maps. keep: None or True, all stage arrays are wanted, not the picture alone.
    covered, bands, found: None, or `Fragments` of all bands of so many rows, (B, 2) where each has them (`Covered`), and
    their `Hits`, by a search that has been (`compared`). All these are types to the compiler: what they rule out is not even
    compiled. faces: (Q,) the face number of each quad. heights, colors, normals, facade: one by one, as Numba's parallel
    loops take no nested tuples. background: (3,). The bands are taken in an order that gives every thread an even sample of
    the picture.
    """
    count = (height + band_rows - 1) // band_rows
    stride = stride_of(count)
    for turn in prange(count):
        band = (turn * stride) % count
        first_row, last_row = band * band_rows, min(height, (band + 1) * band_rows)
        maps = Maps(heights, colors, normals, facade, maxima)
        if patch_id == 0:
            clear(target, background, first_row * width, last_row * width)
        _draw_band(
            repeat, keep, covered, bands, found, band, triangles, faces, constants, settings, maps, patch_id, width,
            first_row, last_row, target,
        )  # fmt: skip
