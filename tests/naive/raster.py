"""conventions.md, "Triangles" and "Texture fetches": clipping, snapping, triangles, bilinear fetch."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

# A vertex is a list of floats: clip x, y, z, w, then the varyings.
Vertex = list[float]
Texel = list[float]


def lerp(a: float, b: float, f: float) -> float:
    return a * (1.0 - f) + b * f


# --- Clipping --------------------------------------------------------------------------------------------------------


def clip_against(polygon: list[Vertex], distance: Callable[[Vertex], float]) -> list[Vertex]:
    """Sutherland-Hodgman against the half-space distance >= 0."""
    result = []
    for i, here in enumerate(polygon):
        there = polygon[(i + 1) % len(polygon)]
        d_here, d_there = distance(here), distance(there)
        if d_here >= 0.0:
            result.append(here)
        if d_here >= 0.0 and d_there < 0.0:
            result.append(intersection(here, there, d_here, d_there))
        if d_here < 0.0 and d_there >= 0.0:
            result.append(intersection(there, here, d_there, d_here))
    return result


def intersection(inside: Vertex, outside: Vertex, d_in: float, d_out: float) -> Vertex:
    """Always from the inside vertex to the outside one, so that triangles with a common edge get the same point."""
    t = d_in / (d_in - d_out)
    return [lerp(a, b, t) for a, b in zip(inside, outside, strict=True)]


def clip_polygon(polygon: list[Vertex], width: int, height: int) -> list[Vertex]:
    """Near, then far, then (only where the window coordinates would be huge) the guard band."""
    polygon = clip_against(polygon, lambda p: p[2])
    polygon = clip_against(polygon, lambda p: p[3] - p[2])
    guard_x = 2.0**21 / width
    guard_y = 2.0**21 / height
    if any(abs(p[0]) > guard_x * p[3] or abs(p[1]) > guard_y * p[3] for p in polygon):
        polygon = clip_against(polygon, lambda p: guard_x * p[3] + p[0])
        polygon = clip_against(polygon, lambda p: guard_x * p[3] - p[0])
        polygon = clip_against(polygon, lambda p: guard_y * p[3] + p[1])
        polygon = clip_against(polygon, lambda p: guard_y * p[3] - p[1])
    return polygon


# --- Triangles -------------------------------------------------------------------------------------------------------


def snap(vertex: Vertex, width: int, height: int) -> tuple[int, int]:
    """The window position in units of 1/256 pixel, rounded to nearest, ties to even (as Python's round does)."""
    x, y, w = vertex[0], vertex[1], vertex[3]
    window_x = ((x / w + 1.0) / 2.0) * width
    window_y = ((1.0 - y / w) / 2.0) * height
    return round(256.0 * window_x), round(256.0 * window_y)


def edge(a: tuple[int, int], b: tuple[int, int], p: tuple[int, int]) -> int:
    """The exact integer edge function; positive to the right of a -> b as seen in the window (y downwards)."""
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def is_top_left(a: tuple[int, int], b: tuple[int, int]) -> bool:
    """For an edge a -> b of a triangle with positive area: a top edge runs to the right, a left edge upwards."""
    return (b[1] == a[1] and b[0] > a[0]) or b[1] < a[1]


def pixel_range(coordinates: list[int], size: int) -> range:
    """The pixels of 0 ... size - 1 whose centres 256 i + 128 lie between the smallest and the largest coordinate."""
    first = -((128 - min(coordinates)) // 256)  # ceil((min - 128) / 256)
    last = (max(coordinates) - 128) // 256
    return range(max(first, 0), min(last, size - 1) + 1)


def covered(corners: list[tuple[int, int]], width: int, height: int) -> Iterator[tuple[int, int, list[int]]]:
    """(column, row, [E_0, E_1, E_2]) of every pixel whose centre the triangle covers, by the top-left rule."""
    p0, p1, p2 = corners
    area = edge(p0, p1, p2)
    if area == 0:
        return
    sign = 1 if area > 0 else -1
    edges = [(p1, p2), (p2, p0), (p0, p1)]
    # Where the area is negative, the edge functions are negated: that is the same edge walked the other way round.
    top_left = [is_top_left(a, b) if sign > 0 else is_top_left(b, a) for a, b in edges]
    for row in pixel_range([p0[1], p1[1], p2[1]], height):
        for column in pixel_range([p0[0], p1[0], p2[0]], width):
            centre = (256 * column + 128, 256 * row + 128)
            weights = [sign * edge(a, b, centre) for a, b in edges]
            if all(e > 0 or (e == 0 and tl) for e, tl in zip(weights, top_left, strict=True)):
                yield column, row, weights


def triangle_fragments(
    a: Vertex, b: Vertex, c: Vertex, width: int, height: int
) -> Iterator[tuple[int, int, float, list[float]]]:
    """Clips and draws one triangle: (column, row, window depth, varyings) of every covered pixel."""
    polygon = clip_polygon([a, b, c], width, height)
    for i in range(1, len(polygon) - 1):
        fan = [polygon[0], polygon[i], polygon[i + 1]]
        corners = [snap(vertex, width, height) for vertex in fan]
        for column, row, weights in covered(corners, width, height):
            yield column, row, window_depth(fan, weights), varyings(fan, weights)


def window_depth(fan: list[Vertex], weights: list[int]) -> float:
    """Linear in window space."""
    z0, z1, z2 = (vertex[2] / vertex[3] for vertex in fan)
    total = float(weights[0] + weights[1] + weights[2])
    e0, e1, e2 = (float(e) for e in weights)
    return ((e0 / total) * z0 + (e1 / total) * z1) + (e2 / total) * z2


def varyings(fan: list[Vertex], weights: list[int]) -> list[float]:
    """Perspective-correct: attribute / w over 1 / w."""
    e0, e1, e2 = (float(e) for e in weights)
    w0, w1, w2 = (vertex[3] for vertex in fan)
    below = (e0 / w0 + e1 / w1) + e2 / w2
    result = []
    for a0, a1, a2 in zip(fan[0][4:], fan[1][4:], fan[2][4:], strict=True):
        result.append((((e0 * a0) / w0 + (e1 * a1) / w1) + (e2 * a2) / w2) / below)
    return result


# --- Textures --------------------------------------------------------------------------------------------------------

INDEX_LIMIT = 2.0**30


def float_floor(x: float) -> float:
    """floor as IEEE has it: an infinity or NaN comes back as it is."""
    return float(math.floor(x)) if math.isfinite(x) else x


def texel_index(floor: float) -> int:
    """An integer from a floor, clamped to +-2^30; NaN counts as 0."""
    if math.isnan(floor):
        return 0
    return int(min(max(floor, -INDEX_LIMIT), INDEX_LIMIT))


def wrap(index: int, size: int, repeat: bool) -> int:
    """The wrap mode: repeat (mathematical modulo) or clamp."""
    if repeat:
        return index % size
    return min(max(index, 0), size - 1)


class Texture:
    """A map of one or more channels, fetched bilinearly."""

    def __init__(self, array: Any, repeat: bool) -> None:
        rows = array.tolist()
        self.height = len(rows)
        self.width = len(rows[0])
        self.repeat = repeat
        # Every texel is a list of channels; a height map has one.
        self.rows: list[list[Texel]] = [
            [[float(c) for c in texel] if isinstance(texel, list) else [float(texel)] for texel in row] for row in rows
        ]

    def fetch(self, u: float, v: float) -> Texel:
        """Bilinear, channel by channel (conventions.md, "Texture fetches")."""
        x = u * self.width - 0.5
        y = v * self.height - 0.5
        x0 = float_floor(x)
        y0 = float_floor(y)
        fx = x - x0
        fy = y - y0
        left = wrap(texel_index(x0), self.width, self.repeat)
        right = wrap(texel_index(x0) + 1, self.width, self.repeat)
        above = self.rows[wrap(texel_index(y0), self.height, self.repeat)]
        below = self.rows[wrap(texel_index(y0) + 1, self.height, self.repeat)]
        return [
            lerp(lerp(t00, t10, fx), lerp(t01, t11, fx), fy)
            for t00, t10, t01, t11 in zip(above[left], above[right], below[left], below[right], strict=True)
        ]

    def value(self, u: float, v: float) -> float:
        """The first channel alone: the height of a height map."""
        return self.fetch(u, v)[0]
