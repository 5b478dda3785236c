"""Whether a mesh is the surface that a plain reader found: the same triangles, polygons covered as they wind."""

from __future__ import annotations

import numpy as np

from ibr_ref.scene import Mesh
from tests.io.plain import Surface

_CLOSE = 1e-9
"""Share of the largest number: places of glTF's nodes are computed in two ways."""


def difference(mesh: Mesh, surface: Surface) -> str:
    """Nothing, or what is different."""
    vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    corners = np.concatenate([vertices, np.broadcast_to(mesh.color, vertices.shape)], axis=1)
    if all(len(polygon) == 3 for polygon in surface):
        return _different_triangles(corners[triangles], np.array(surface))
    if len(triangles) != sum(len(polygon) - 2 for polygon in surface):
        return f"{len(triangles)} triangles, {sum(len(polygon) - 2 for polygon in surface)} wanted"
    place = 0
    for k, polygon in enumerate(surface):
        cut = corners[triangles[place : place + len(polygon) - 2]]
        problem = _uncovered(np.array(polygon), cut)
        if problem:
            return f"polygon {k}: {problem}"
        place += len(cut)
    return ""


def _different_triangles(found: np.ndarray, wanted: np.ndarray) -> str:
    if found.shape != wanted.shape:
        return f"{len(found)} triangles, {len(wanted)} wanted"
    sizes = np.abs(wanted).max(axis=(0, 1))
    turned = [np.abs(np.roll(found, k, axis=1) - wanted) <= _CLOSE * sizes for k in range(3)]
    bad = ~np.any([same.all(axis=(1, 2)) for same in turned], axis=0)
    return f"triangle {np.flatnonzero(bad)[0]} of {len(found)}" if bad.any() else ""


def _uncovered(polygon: np.ndarray, cut: np.ndarray) -> str:
    """Each point is covered as often as the polygon goes round it: looked at in the plane that shows it largest."""
    if not all((corner == polygon).all(axis=1).any() for corner in cut.reshape(-1, 6)):
        return "corners of another"
    if len(polygon) == 3:
        return "" if any((np.roll(cut[0], k, axis=0) == polygon).all() for k in range(3)) else "another triangle"
    points = polygon[:, :3] / np.abs(polygon[:, :3]).max()
    cut = cut[:, :, :3] / np.abs(polygon[:, :3]).max()
    middle = points.mean(axis=0)
    normal = sum(np.cross(a - middle, b - middle) for a, b in zip(points, np.roll(points, -1, axis=0), strict=True))
    extent = np.abs(points - middle).max()
    problem = ""
    for axis in np.flatnonzero(np.abs(normal) >= (1.0 - 1e-9) * np.abs(normal).max()):
        shown = [other for other in range(3) if other != axis]
        problem = _covered_otherwise((points - middle)[:, shown] / extent, (cut - middle)[:, :, shown] / extent)
        if not problem:
            break
    return problem


def _covered_otherwise(flat: np.ndarray, pieces: np.ndarray) -> str:
    random = np.random.default_rng(len(flat))
    mixed = random.dirichlet([1.0] * 3, (len(pieces), 4))
    samples = np.concatenate([np.einsum("tsk,tkd->tsd", mixed, pieces).reshape(-1, 2), random.uniform(-1, 1, (40, 2))])
    samples = samples[_clearance(samples, flat, pieces) > 1e-7]
    around, each = _turns(samples, flat), np.stack([_turns(samples, piece) for piece in pieces])
    covered, absolute = each.sum(axis=0), np.abs(each).sum(axis=0)
    bad = np.flatnonzero((covered != around) | (absolute != np.abs(around)))
    if len(bad):
        return f"covered {covered[bad[0]]} ({absolute[bad[0]]}) times where it winds {around[bad[0]]} times"
    return ""


def _clearance(samples: np.ndarray, flat: np.ndarray, pieces: np.ndarray) -> np.ndarray:
    """(S,) distances from the nearest edge."""
    starts = np.concatenate([flat, pieces.reshape(-1, 2)])
    way = np.concatenate([np.roll(flat, -1, axis=0), np.roll(pieces, -1, axis=1).reshape(-1, 2)]) - starts
    off = samples[:, None] - starts
    share = np.clip((off * way).sum(axis=2) / np.maximum((way * way).sum(axis=1), 1e-300), 0.0, 1.0)
    return np.sqrt(((off - share[..., None] * way) ** 2).sum(axis=2)).min(axis=1)


def _turns(samples: np.ndarray, loop: np.ndarray) -> np.ndarray:
    """(S,) how often a closed loop goes round each point, counted on a ray towards +x."""
    (x0, y0), (x1, y1) = (
        np.moveaxis(loop - samples[:, None], 2, 0),
        np.moveaxis(np.roll(loop, -1, axis=0) - samples[:, None], 2, 0),
    )
    rising = y1 > y0
    met = ((y0 <= 0.0) != (y1 <= 0.0)) & ((x0 * y1 - x1 * y0 > 0.0) == rising)
    return np.where(met, np.where(rising, 1, -1), 0).sum(axis=1)
