"""Protruded displacement mapping (Yoo & Han 2006): shapes that stick out of a polygon, by a search along the view ray.

`render(Scene, Params)` draws base polygons with height maps. The polygon is the *bottom* of the displaced volume, so the
ground does not move; auxiliary faces catch what overflows its outline; abrupt walls are found in the search and textured
by themselves.

Patch space is (u, v, h): world p = corner + u U + v V + h s n, n = normalize(U x V), s the height scale. The volume is the
unit cube and it is solid. The way back is the reciprocal basis of (U, V, s n): rows (V x s n)/det, (s n x U)/det,
(U x V)/det, det = U.(V x s n), each times (p - corner). The eye and the light are homogeneous there: (x, y, z, 1), or a
direction (x, y, z, 0) for an orthographic camera and a directional light; e - w p is the way from p towards them.

`ibr-ref method displacement` prints the method, stage by stage: formulas, ties, every array with shape, dtype and "nothing",
and what the paper leaves open (`method.md` beside this file). `contract.STAGES` is the table of the arrays.

**Systems to compare with** (`method=`), all on the base face alone: `"texture"`; `"relief"` (Policarpo 2005); `"welsh"`,
`"mcguire"`, `"donnelly"` and `"tatarchuk"` of the paper's table 1; and beyond the paper `"cone"` (Dummer 2006),
`"relaxed_cone"` (Policarpo & Oliveira 2007) and `"maximum_mipmap"` (Tevs 2008, Drobot 2009). Each has a file with its source
and its formulas. `"exact"` is the first intersection with the bilinear height field itself.
"""

from ibr_ref.displacement.bounds import bounding_points
from ibr_ref.displacement.culling import culled
from ibr_ref.displacement.inputs import Params, Scene
from ibr_ref.displacement.render import render

__all__ = ["Params", "Scene", "bounding_points", "culled", "render"]
