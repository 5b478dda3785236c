"""What the splatting port may differ by: stage 3 in `Rounded` numbers, and the pixels that no rounding can turn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tests.ports.rounding import LOOSE, UNIT, Rounded, dot, power, total, unit

SUBPIXEL = 1.0 / 256.0


def vertex_bounds(scene: Any, params: Any, normals: Sequence[np.ndarray]) -> dict[str, Rounded]:
    """Stage 3 of all points: "window_x", "window_y", "depth", "width", "near", "far" (V,), "color" (V, 3).

    near and far: clip z and w − z, whose signs decide whether a point is kept.
    """
    parts = [_image_bounds(scene, params, *pair) for pair in zip(scene.images, normals, strict=True)]
    return {
        name: Rounded(
            np.concatenate([part[name].value for part in parts]), np.concatenate([part[name].error for part in parts])
        )
        for name in parts[0]
    }


def _image_bounds(scene: Any, params: Any, image: Any, codes: np.ndarray) -> dict[str, Rounded]:
    """The points of one reference image."""
    camera, mask = scene.camera, np.asarray(image.mask)
    world = _transform(image.camera.world_from_view, _unproject(image))[:3]
    view = _transform(camera.view_from_world, world)[:3]
    clip = _transform(camera.clip_from_view, view)
    x, y, z = (coordinate / clip[3] for coordinate in clip[:3])
    one, half = Rounded.of(1.0), Rounded.of(0.5)
    eye = [Rounded.of(value) for value in np.asarray(camera.eye, float)]
    towards_eye = [b - a for a, b in zip(world, eye[:3], strict=True)]
    distance = dot(towards_eye, towards_eye).root() if camera.perspective else -view[2]
    albedo = [Rounded.of(np.asarray(image.color)[mask][:, channel]) for channel in range(3)]
    normal = unit([Rounded.of(codes[mask][:, channel] - 128.0) for channel in range(3)])
    colors = albedo if scene.light is None else _lit(scene, world, normal, albedo)
    colors = [color + Rounded(np.zeros(1), np.full(1, LOOSE)) for color in colors]  # bytes / 255 in the shader
    return {
        "window_x": (x + one) * half * Rounded.of(camera.width),
        "window_y": (one - y) * half * Rounded.of(camera.height),
        "depth": z,
        "width": _width(params, distance),
        "near": clip[2],
        "far": clip[3] - clip[2],
        "color": Rounded(np.stack([c.value for c in colors], 1), np.stack([c.error for c in colors], 1)),
    }


def _unproject(image: Any) -> list[Rounded]:
    """x, y, z of the valid pixels' centres in the reference camera's view space."""
    camera, mask = image.camera, np.asarray(image.mask)
    (f_x, skew, c_x), (_, f_y, c_y), _ = np.asarray(camera.intrinsics, float).tolist()
    rows, columns = (index + 0.5 for index in np.nonzero(mask))
    y = (Rounded.of(rows) - Rounded.of(c_y)) * Rounded.of(1.0 / f_y)
    x = total([Rounded.of(columns), -Rounded.of(c_x), -(Rounded.of(skew) * y)]) * Rounded.of(1.0 / f_x)
    depth = Rounded.of(np.asarray(image.depth)[mask])
    if camera.perspective:
        x, y = x * depth, y * depth
    return [x, -y, -depth]


def _transform(matrix: Any, point: Sequence[Rounded]) -> list[Rounded]:
    """The four rows applied to a point of w = 1."""
    one = Rounded.of(np.ones_like(point[0].value))
    return [dot([Rounded.of(value) for value in row], [*point, one]) for row in np.asarray(matrix, float)]


def _width(params: Any, d: Rounded) -> Rounded:
    """The rational law, clamped."""
    terms = [Rounded.of(params.beta) * (d * d), Rounded.of(params.gamma) * d, Rounded.of(params.delta)]
    return (Rounded.of(params.alpha) / total(terms)).between(params.min_width, params.max_width)


def _lit(scene: Any, world: Sequence[Rounded], normal: Sequence[Rounded], albedo: Sequence[Rounded]) -> list[Rounded]:
    """Phong's lighting, where the sign of n·l is not certain as far off as the highlight is bright."""
    light = scene.light
    towards = _towards(light.homogeneous, world)
    view = _towards(scene.camera.eye, world)
    facing = dot(normal, towards)
    two = Rounded.of(2.0)
    reflected = [two * facing * n - l for n, l in zip(normal, towards, strict=True)]
    shine = Rounded.of(light.specular) * power(dot(reflected, view).positive(), light.exponent)
    dark = Rounded(np.zeros_like(shine.value), np.zeros_like(shine.error))
    undecided = Rounded(shine.value, np.abs(shine.value) + shine.error)
    highlight = undecided.where(np.abs(facing.value) <= facing.error, shine.where(facing.value > 0.0, dark))
    brightness = Rounded.of(light.ambient) + Rounded.of(light.diffuse) * facing.positive()
    return [(color * brightness + highlight).between(0.0, 1.0) for color in albedo]


def _towards(source: Any, point: Sequence[Rounded]) -> list[Rounded]:
    """The unit vector from a point towards a homogeneous source."""
    *xyz, w = (Rounded.of(value) for value in np.asarray(source, float))
    return unit([a - w * p for a, p in zip(xyz, point, strict=True)])


def undecided_pixels(bounds: dict[str, Rounded], stages: dict[str, np.ndarray], shape: str, slack: float) -> np.ndarray:
    """(H, W) bool: a splat whose border passes too near to the pixel's centre could be the winner there, or depths tie.

    slack: how far the device may put a border of a splat from where it belongs, in pixels.
    """
    depth, error = bounds["depth"], np.nanmax(bounds["depth"].error) + 2.0 * UNIT
    undecided = stages["raster.margin"] <= 2.0 * error
    kept_or_not = (np.abs(bounds["near"].value) <= bounds["near"].error) | (
        np.abs(bounds["far"].value) <= bounds["far"].error
    )
    for vertex in np.flatnonzero(np.isfinite(stages["vertex.depth"]) | kept_or_not):
        inner, outer, box = _coverage(bounds, vertex, shape, slack, undecided.shape)
        maybe = outer & ~inner if not kept_or_not[vertex] else outer
        undecided[box] |= maybe & (depth.value[vertex] <= stages["raster.depth"][box] + 2.0 * error)
    return undecided


def _coverage(
    bounds: dict[str, Rounded], vertex: int, shape: str, slack: float, size: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray, tuple[slice, slice]]:
    """Pixels certainly and possibly covered by one splat, inside the box (rows, columns) of the picture's that are asked."""
    width, off = bounds["width"].value[vertex], bounds["width"].error[vertex]
    least, most = (width - off) / 2.0 - slack, (width + off) / 2.0 + slack
    axes = [
        _axis(bounds[name], vertex, least, most, count)
        for name, count in zip(("window_y", "window_x"), size, strict=True)
    ]
    (rows, row_in, row_near, row_far), (columns, column_in, column_near, column_far) = axes
    inner, outer = np.logical_and.outer(row_in, column_in), np.ones((len(row_in), len(column_in)), bool)
    if shape == "disc":
        tiny = 1e-5  # the squares in float32, of at most some tens of pixels
        inner &= np.add.outer(row_far**2, column_far**2) <= max(least - tiny, 0.0) ** 2
        outer &= np.add.outer(row_near**2, column_near**2) <= (most + tiny) ** 2
    return inner, outer, (rows, columns)


def _axis(
    center: Rounded, vertex: int, least: float, most: float, count: int
) -> tuple[slice, np.ndarray, np.ndarray, np.ndarray]:
    """Along one axis: pixels that may be covered; which certainly are; their least and largest distance from the centre."""
    value, error = center.value[vertex], center.error[vertex]
    low, high = (np.rint(end / SUBPIXEL) * SUBPIXEL for end in (value - error, value + error))
    first = int(np.clip(np.ceil(low - most - 0.5), 0, count))
    last = int(np.clip(np.ceil(high + most - 0.5), first, count))
    pixels = np.arange(first, last) + 0.5
    certain = (pixels >= high - least) & (pixels < low + least)
    near = np.maximum(0.0, np.maximum(low - pixels, pixels - high))
    return slice(first, last), certain, near, np.maximum(np.abs(pixels - low), np.abs(pixels - high))
