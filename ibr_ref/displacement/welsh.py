"""Parallax mapping with offset limiting (Welsh 2004): one fetch, one step along the polygon.

T = C + H(C) s w_xy, w the unit vector to the eye in the polygon's own frame: not divided by w's height, so that the offset
never exceeds the height itself. Nothing is displaced: the hit lies on the polygon, at the texture coordinates T.

Arrays: points (3, P), found and fetches (P,), one a point, as in `sought.Sought`.
"""

from __future__ import annotations

from ibr_ref.array_types import Floats, Indices, Texels, Wrap
from ibr_ref.displacement.below import distance_to_eye, keep, view_ray
from ibr_ref.displacement.buffers import Hits, Uniforms
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.sampling import fetch


@device
def _offset(
    repeat: Wrap, points: Floats, i: int, constants: Uniforms, texels: Texels, columns: float, rows: float,
    found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """The offset of a point."""
    u, v, along_u, along_v, seen = view_ray(points, i, constants.eye)
    if not seen:
        return
    height = fetch(texels, columns, rows, repeat, u, v) * constants.scale
    length = distance_to_eye(constants, along_u, along_v)  # of w / w_h: so (U*.w, V*.w) is (along_u, along_v) / length
    fetches[i] = 1
    keep(found, i, 0, u + height * along_u / length, v + height * along_v / length, 0.0, repeat is None)


@kernel
def welsh_search(
    repeat: Wrap, points: Floats, constants: Uniforms, texels: Texels, columns: float, rows: float, found: Hits,
    fetches: Indices,
) -> None:  # fmt: skip
    """Offsets of all points."""
    for i in prange(len(fetches)):
        _offset(repeat, points, i, constants, texels, columns, rows, found, fetches)


def search(s: Sought) -> None:
    """Offsets of a polygon."""
    welsh_search(s.repeat, s.points, s.constants, *s.height, *s.found)
