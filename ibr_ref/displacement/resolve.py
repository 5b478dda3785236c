"""Resolve stage: window depth of the hits, depth test, and what a pixel shows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Floats, Indices, Ints
from ibr_ref.contract import IMAGE, StageArray
from ibr_ref.displacement.buffers import Fragments, Hits, Settings, Shades, Uniforms
from ibr_ref.displacement.contract import FRAGMENT_FIELDS, STAGES
from ibr_ref.jit import LANES, device, kernel, prange
from ibr_ref.pipeline.memory import Layout, arrays
from ibr_ref.pipeline.merge import passes
from ibr_ref.pipeline.waves import lanes, load, load_indices, store, store_indices


class Target(NamedTuple):
    """The frame's arrays, one row a pixel: (P,) or (P, 3). Without stages all but the first two are empty."""

    color: Floats
    depth: Floats
    face: Indices
    patch_id: Indices
    patch: Floats
    linear_index: Indices
    hit_index: Indices
    hit: Floats
    height_before: Floats
    steep: Bools
    margin: Floats
    domain_margin: Floats
    steep_margin: Floats
    albedo: Floats
    normal: Floats
    lit: Bools
    lit_margin: Floats
    axis_margin: Floats
    facing_margin: Floats
    second: Floats
    """Window depth of the nearest kept fragment behind the one that is shown."""


def _entry(field: str) -> StageArray:
    """The contract's entry of a field of the target."""
    if field in FRAGMENT_FIELDS:
        return STAGES[FRAGMENT_FIELDS[field]]
    return IMAGE["depth" if field == "second" else field]


def target_for(pixels: int, keep: bool) -> Target:
    """Arrays for a picture of so many pixels, not yet cleared."""

    def layouts(names: tuple[str, ...], count: int) -> list[Layout]:
        entries = [_entry(name) for name in names]
        return [(np.dtype(entry.dtype).type, (count, *map(int, entry.shape[2:]))) for entry in entries]

    picture, stages = Target._fields[:2], Target._fields[2:]
    # Apart: whoever keeps the picture alone does not keep the memory of the stages.
    return Target(*arrays(layouts(picture, pixels)), *arrays(layouts(stages, pixels if keep else 0)))


@device
def _fill(array: Floats | Indices | Bools, first: int, last: int, value: float) -> None:
    """array (P,)."""
    for i in range(first, last):
        array[i] = value


@device
def _fill_triples(array: Floats, first: int, last: int, x: float, y: float, z: float) -> None:
    """array (P, 3)."""
    for i in range(first, last):
        array[i, 0], array[i, 1], array[i, 2] = x, y, z


@device
def clear(target: Target, background: Floats, first: int, last: int) -> None:
    """Nothing at the pixels [first, last): the background at depth 1; -1, NaN and False in the stages. background (3,)."""
    _fill(target.depth, first, last, 1.0)
    _fill_triples(target.color, first, last, background[0], background[1], background[2])
    if len(target.face) == 0:
        return
    for indices in (target.face, target.patch_id, target.linear_index, target.hit_index):
        _fill(indices, first, last, -1)
    for truths in (target.steep, target.lit):
        _fill(truths, first, last, False)
    for numbers in (
        target.height_before,
        target.margin,
        target.domain_margin,
        target.steep_margin,
        target.lit_margin,
        target.axis_margin,
        target.facing_margin,
    ):
        _fill(numbers, first, last, np.nan)
    _fill(target.second, first, last, np.inf)
    for triples in (target.patch, target.hit, target.albedo, target.normal):
        _fill_triples(triples, first, last, np.nan, np.nan, np.nan)


@device
def project_hits(fragments: Fragments, count: int, constants: Uniforms, settings: Settings, hits: Hits) -> None:
    """Window depth of each hit; a hit in front of the near plane is discarded, as if nothing had been found."""
    c, a, view, clip = constants.corner, constants.axes, constants.view_from_world, constants.clip_from_view
    world = (
        (c[0], a[0, 0], a[1, 0], a[2, 0]),
        (c[1], a[0, 1], a[1, 1], a[2, 1]),
        (c[2], a[0, 2], a[1, 2], a[2, 2]),
    )
    rows = (
        (view[0, 0], view[0, 1], view[0, 2], view[0, 3]),
        (view[1, 0], view[1, 1], view[1, 2], view[1, 3]),
        (view[2, 0], view[2, 1], view[2, 2], view[2, 3]),
        (view[3, 0], view[3, 1], view[3, 2], view[3, 3]),
    )
    row_z = (clip[2, 0], clip[2, 1], clip[2, 2], clip[2, 3])
    row_w = (clip[3, 0], clip[3, 1], clip[3, 2], clip[3, 3])
    u, v, h, depth = lanes(), lanes(), lanes(), lanes()
    index, linear, before, steep = lanes(), lanes(), lanes(), lanes()
    for first in range(0, count, LANES):
        load(hits.u, first, u)
        load(hits.v, first, v)
        load(hits.h, first, h)
        load_indices(hits.hit_index, first, index)
        load_indices(hits.linear_index, first, linear)
        load(hits.height_before, first, before)
        load(hits.steep_margin, first, steep)
        for lane in range(LANES):
            p_u, p_v, p_h = u[lane], v[lane], h[lane]
            x = world[0][0] + p_u * world[0][1] + p_v * world[0][2] + p_h * world[0][3]
            y = world[1][0] + p_u * world[1][1] + p_v * world[1][2] + p_h * world[1][3]
            z = world[2][0] + p_u * world[2][1] + p_v * world[2][2] + p_h * world[2][3]
            view_x = rows[0][0] * x + rows[0][1] * y + rows[0][2] * z + rows[0][3]
            view_y = rows[1][0] * x + rows[1][1] * y + rows[1][2] * z + rows[1][3]
            view_z = rows[2][0] * x + rows[2][1] * y + rows[2][2] * z + rows[2][3]
            view_w = rows[3][0] * x + rows[3][1] * y + rows[3][2] * z + rows[3][3]
            clip_z = row_z[0] * view_x + row_z[1] * view_y + row_z[2] * view_z + row_z[3] * view_w
            clip_w = row_w[0] * view_x + row_w[1] * view_y + row_w[2] * view_z + row_w[3] * view_w
            kept = (index[lane] >= 0.0) & (not (clip_z < 0.0))
            index[lane] = index[lane] if kept else -1.0
            linear[lane] = linear[lane] if kept else -1.0
            before[lane] = before[lane] if kept else 0.0
            steep[lane] = steep[lane] if kept else np.nan
            u[lane] = p_u if kept else np.nan
            v[lane] = p_v if kept else np.nan
            h[lane] = p_h if kept else np.nan
            depth[lane] = clip_z / clip_w
        store(u, hits.u, first)
        store(v, hits.v, first)
        store(h, hits.h, first)
        store_indices(index, hits.hit_index, first)
        store_indices(linear, hits.linear_index, first)
        store(before, hits.height_before, first)
        if settings.polygon_depth:
            load(fragments.depth, first, depth)
        store(depth, hits.depth, first)
        store(steep, hits.steep_margin, first)


SHOWN, NOTED, HIDDEN = 2, 1, 0
"""A fragment that passes the depth test; one that does not, but is the first on its pixel; any other."""

Verdicts = NDArray[np.int8]
"""(F,): which of these each fragment of a band is."""


@device
def depth_test(fragments: Fragments, hits: Hits, count: int, target: Target, verdicts: Verdicts) -> int:
    """Depth test LESS in submission order; how many fragments passed. Writes the depth."""
    shown = 0
    for i in range(count):
        pixel, depth = fragments.pixel[i], hits.depth[i]
        passed = hits.hit_index[i] >= 0 and passes(depth, target.depth[pixel])
        verdicts[i] = SHOWN if passed else HIDDEN
        if passed:
            target.depth[pixel] = depth
            shown += 1
    return shown


@device
def noted_depth_test(fragments: Fragments, hits: Hits, count: int, target: Target, verdicts: Verdicts) -> int:
    """The same, and what the stages need: first fragments on their pixels, and the depth behind the one that is shown."""
    shown = 0
    for i in range(count):
        pixel, depth = fragments.pixel[i], hits.depth[i]
        kept = hits.hit_index[i] >= 0
        before = target.depth[pixel]
        passed = kept and passes(depth, before)
        if passed and before < 1.0:  # the one shown so far lies behind
            target.second[pixel] = min(target.second[pixel], before)
        elif kept and not passed:
            target.second[pixel] = min(target.second[pixel], depth)
        verdicts[i] = SHOWN if passed else (NOTED if target.face[pixel] < 0 else HIDDEN)
        if passed:
            target.depth[pixel] = depth
            shown += 1
        if verdicts[i] != HIDDEN:
            target.face[pixel] = fragments.face[i]
    return shown


@device
def _copy(
    verdicts: Verdicts, pixels: Ints, count: int, source: Floats | Indices | Bools,
    destination: Floats | Indices | Bools,
) -> None:  # fmt: skip
    """From source (F,) to destination (P,), where a fragment's pixel (F,) notes it."""
    for i in range(count):
        if verdicts[i] != HIDDEN:
            destination[pixels[i]] = source[i]


@device
def _copy_triple(
    verdicts: Verdicts, pixels: Ints, count: int, x: Floats, y: Floats, z: Floats, destination: Floats
) -> None:
    """From x, y, z (F,) to destination (P, 3)."""
    for i in range(count):
        if verdicts[i] != HIDDEN:
            pixel = pixels[i]
            destination[pixel, 0], destination[pixel, 1], destination[pixel, 2] = x[i], y[i], z[i]


@device
def write_color(fragments: Fragments, shades: Shades, count: int, verdicts: Verdicts, target: Target) -> None:
    """Colour of the fragments that passed, in submission order."""
    color = shades.color
    for i in range(count):
        if verdicts[i] == SHOWN:
            pixel = fragments.pixel[i]
            target.color[pixel, 0], target.color[pixel, 1] = color[0, i], color[1, i]
            target.color[pixel, 2] = color[2, i]


@device
def write_stages(
    fragments: Fragments, hits: Hits, count: int, patch_id: int, verdicts: Verdicts, target: Target
) -> None:
    """raster.* and march.* of the fragments that their pixels note."""
    pixels = fragments.pixel
    for i in range(count):
        if verdicts[i] != HIDDEN:
            target.patch_id[pixels[i]] = patch_id
    _copy_triple(verdicts, pixels, count, fragments.patch[0], fragments.patch[1], fragments.patch[2], target.patch)
    _copy_triple(verdicts, pixels, count, hits.u, hits.v, hits.h, target.hit)
    _copy(verdicts, pixels, count, hits.linear_index, target.linear_index)
    _copy(verdicts, pixels, count, hits.hit_index, target.hit_index)
    _copy(verdicts, pixels, count, hits.height_before, target.height_before)
    _copy(verdicts, pixels, count, hits.steep, target.steep)
    _copy(verdicts, pixels, count, hits.margin, target.margin)
    _copy(verdicts, pixels, count, hits.domain_margin, target.domain_margin)
    _copy(verdicts, pixels, count, hits.steep_margin, target.steep_margin)


@device
def write_shades(
    fragments: Fragments, hits: Hits, shades: Shades, count: int, verdicts: Verdicts, target: Target
) -> None:
    """shade.* of the fragments that their pixels note, if they were kept; NaN and False otherwise."""
    pixels = fragments.pixel
    for i in range(count):
        if verdicts[i] == HIDDEN:
            continue
        pixel = pixels[i]
        kept = hits.hit_index[i] >= 0
        for channel in range(3):
            target.albedo[pixel, channel] = shades.albedo[channel, i] if kept else np.nan
            target.normal[pixel, channel] = shades.normal[channel, i] if kept else np.nan
        target.lit[pixel] = shades.lit[i] and kept
        target.lit_margin[pixel] = shades.lit_margin[i] if kept else np.nan
        target.axis_margin[pixel] = shades.axis_margin[i] if kept else np.nan
        target.facing_margin[pixel] = shades.facing_margin[i] if kept else np.nan


@kernel
def resolve_margins(target: Target, margin: Floats) -> None:
    """Distance in depth from what is shown to the nearest other kept fragment; NaN where no face covers the pixel.

    `margin` (P,) may be the array `second` of the target itself.
    """
    chunk = 4096
    pixels = len(margin)
    for part in prange((pixels + chunk - 1) // chunk):
        for i in range(part * chunk, min(pixels, (part + 1) * chunk)):
            shown = target.depth[i] < 1.0
            distance = abs(target.second[i] - target.depth[i]) if shown else np.inf
            margin[i] = np.nan if target.face[i] < 0 else distance
