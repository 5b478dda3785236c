"""Which reference images to keep: the fewest that still show the surface (the paper's open problem, section 5).

The surface is what all images together know of it: their points, each standing for the area of its pixel's footprint on the
surface, divided among the images that see it. An image sees a point if the point lands on one of its valid pixels at that
pixel's depth. To find the fewest images for a coverage is set cover, which is NP-hard; the greedy choice, again and again
the image that adds the most area, needs at most ln n times as many, and no algorithm that is practical promises less
(Feige 1998); of all choices of so many images it covers at least 1 - 1/e of what the best one does (Nemhauser et al. 1978).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.pipeline.transform import transformed
from ibr_ref.scene import DepthImage, checks
from ibr_ref.splatting.normals import valid_mask
from ibr_ref.splatting.references import Prepared, prepare
from ibr_ref.splatting.unproject import world_points

_UNITS = 2**40
"""Areas are counted in whole units, this many in all: their sums are exact, in any order."""

_LEAST_COSINE = 0.2
"""Between normal and line of sight: grazing footprints count with at most five times the area of one that faces the eye."""


class Selection(NamedTuple):
    """What `choose_references` chose, the best first."""

    order: tuple[int, ...]
    """Indices of the images."""
    shares: tuple[float, ...]
    """Share of the surface that is seen with so many of them."""


def choose_references(images: Sequence[DepthImage], coverage: float = 0.99, *, tolerance: float = 0.01) -> Selection:
    """Choose, greedily, as few of the images as see the share `coverage` of the surface that all of them know.

    coverage: in (0, 1]. tolerance: a point is seen where its depth is a pixel's up to this share of it, in (0, 1]. On a tie
    the earlier image is chosen. Raises ValueError for images without a valid pixel, and for what is out of range.
    """
    coverage = checks.number("coverage", coverage, above=0.0, high=1.0)
    tolerance = checks.number("tolerance", tolerance, above=0.0, high=1.0)
    for i, image in enumerate(images):
        if not isinstance(image, DepthImage):
            raise checks.reject(f"images[{i}]", type(image).__name__, "DepthImage")
    references = [prepare(image) for image in images]
    if not any(reference.points for reference in references):
        raise checks.reject("images", f"{len(references)} images without a valid pixel", "at least one valid pixel")
    seen = seen_points(images, tolerance)
    return greedy(seen, point_areas(images, seen), coverage)


def greedy(seen: NDArray[np.bool_], areas: NDArray[np.int64], coverage: float) -> Selection:
    """The same for points (V,) of which the images see `seen` (N, V)."""
    total, covered = int(areas.sum()), 0
    left, order, shares = areas.copy(), [], []
    while covered < coverage * total:
        gains = [int(left[row].sum()) for row in seen]
        best = int(np.argmax(gains))
        left[seen[best]] = 0
        covered += gains[best]
        order.append(best)
        shares.append(covered / total)
    return Selection(tuple(order), tuple(shares))


def seen_points(images: Sequence[DepthImage], tolerance: float) -> NDArray[np.bool_]:
    """(N, V) which image sees which of the points of all images, in order of (image, row, column)."""
    references = [prepare(image) for image in images]
    points = np.concatenate([world_points(r.reference)[r.reference.pixels] for r in references])
    seen = np.stack([_sees(image, points, tolerance) for image in images])
    first = 0
    for i, reference in enumerate(references):
        seen[i, first : first + reference.points] = True  # its own, whatever the rounding says
        first += reference.points
    return seen


def _sees(image: DepthImage, points: NDArray[np.float64], tolerance: float) -> NDArray[np.bool_]:
    """(V,) whether world points (V, 3) land on a valid pixel at its depth."""
    camera, reference = image.camera, prepare(image).reference
    x, y, z, _ = transformed(camera.view_from_world, points).T
    (f_x, skew, center_x), (_, f_y, center_y), _ = camera.intrinsics
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = -z if camera.perspective else np.ones(len(z))
        x, y = x / scale, -y / scale
        column, row = np.floor(f_x * x + skew * y + center_x), np.floor(f_y * y + center_y)
    rows, columns = len(reference.row_starts) - 1, reference.columns
    inside = (z < 0.0) & (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    pixel = np.where(inside, row * columns + column, 0.0).astype(np.int64)
    depth = reference.depth[pixel]
    result: NDArray[np.bool_] = inside & valid_mask(reference)[pixel] & (np.abs(-z - depth) <= tolerance * depth)
    return result


def point_areas(images: Sequence[DepthImage], seen: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(V,) what each point counts for, in whole units, at least one; seen (N, V): which image sees which point."""
    areas = np.concatenate([_footprints(prepare(image)) for image in images]) / seen.sum(axis=0)
    units: NDArray[np.int64] = np.maximum(1.0, np.floor(areas / areas.sum() * _UNITS)).astype(np.int64)
    return units


def _footprints(prepared: Prepared) -> NDArray[np.float64]:
    """(points,) areas on the surface of a reference image's pixels."""
    reference = prepared.reference
    points = world_points(reference)[reference.pixels]
    depth = reference.depth[reference.pixels]
    codes = (prepared.normals[reference.pixels].astype(np.float64) - 128.0) / 127.0
    sight = reference.eye[:3] - reference.eye[3] * points
    lengths = np.sqrt((codes * codes).sum(axis=1) * (sight * sight).sum(axis=1))
    cosine = np.maximum(np.abs((codes * sight).sum(axis=1)) / lengths, _LEAST_COSINE)
    distance = depth if reference.perspective else np.ones(len(depth))
    k = reference.intrinsics
    result: NDArray[np.float64] = distance * distance / np.abs(k[0, 0] * k[1, 1]) / cosine
    return result
