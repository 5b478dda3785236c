"""Protruded displacement mapping (Yoo & Han 2006): shapes that stick out of a polygon, by a search along the view ray.

`render(Scene, Params)` draws base polygons with height maps. The polygon is the *bottom* of the displaced volume, so the
ground does not move; auxiliary faces catch what overflows its outline; abrupt walls are found in the search and textured
by themselves.

Patch space is (u, v, h): world p = corner + u U + v V + h s n, n = normalize(U x V), s the height scale. The volume is the
unit cube and it is solid. The way back is the reciprocal basis of (U, V, s n): rows (V x s n)/det, (s n x U)/det,
(U x V)/det, det = U.(V x s n), each times (p - corner). The eye and the light are homogeneous there: (x, y, z, 1), or a
direction (x, y, z, 0) for an orthographic camera and a directional light; e - w p is the way from p towards them.

**Stage arrays** (`frame.stages`). H x W is the picture; a pixel holds the fragment that it shows, else the first submitted
one that covers it. "Nothing here" (no face covers the pixel) is -1, NaN or False. A discarded fragment has hit_index -1,
hit and shade.* NaN, height_before 0, steep False.

| name | shape, dtype | what |
|---|---|---|
| vertex.clip | (n, 4) float64 | corners of all drawn faces in clip space: polygons, then faces, then a, b, c, d |
| vertex.patch | (n, 3) float64 | the same in patch space |
| raster.face | (H, W) int32 | 0 base, 1 u=0, 2 u=1, 3 v=0, 4 v=1, 5 top |
| raster.patch_id | (H, W) int32 | index of the polygon in the scene |
| raster.patch | (H, W, 3) float64 | C, the fragment's point on its face |
| march.linear_index | (H, W) int32 | i, step at which the linear search stopped; -1 none |
| march.hit_index | (H, W) int32 | k, lattice index of the hit, t = k/(N 2^M); -1 discarded |
| march.hit | (H, W, 3) float64 | (u, v, h) of the hit |
| march.height_before | (H, W) float64 | a, the height map at linear step i - 1; 0 where that sample is empty |
| march.steep | (H, W) bool | whether h - a > delta |
| march.margin | (H, W) float64 | smallest abs(h - H) compared, without h = 0 and h = 1; inf if none is left |
| march.domain_margin | (H, W) float64 | smallest distance in (u, v) of a tested sample from the border; inf without |
| march.steep_margin | (H, W) float64 | abs(h - a - delta) |
| shade.albedo | (H, W, 3) float64 | colour or facade map at the hit |
| shade.normal | (H, W, 3) float64 | unit normal in world space |
| shade.lit | (H, W) bool | not in self-shadow |
| shade.lit_margin | (H, W) float64 | smallest abs(h + bias - H) of the shadow's samples; inf without samples |
| shade.axis_margin | (H, W) float64 | how clearly a facade's wall faces u or v; inf without a facade |
| shade.facing_margin | (H, W) float64 | abs(n.l) |
| resolve.margin | (H, W) float64 | distance in window depth to the nearest other kept fragment; inf if there is none |

**Systems to compare with** (`method=`), all on the base face alone: `"texture"`; `"relief"` (Policarpo 2005); `"welsh"`,
`"mcguire"`, `"donnelly"` and `"tatarchuk"` of the paper's table 1; and beyond the paper `"cone"` (Dummer 2006),
`"relaxed_cone"` (Policarpo & Oliveira 2007) and `"maximum_mipmap"` (Tevs 2008, Drobot 2009). Each has a file with its source
and its formulas. The last seven have one stage more, `march.fetches` (H, W) int32: the texture fetches of the search. They
keep no steep walls; their `linear_index` and `hit_index` are the number of the step that the search ended with (of the
maximum mipmap: of fetches). Margins are kept for comparisons with the map alone: none for the number of steps that depends
on the view's angle, for steps by distances or cones, for the quadtree's nodes. Where the map ends at its border, whatever
would be shown from beside it is discarded. `"welsh"` has the polygon's window depth.

**Settled here**, where the paper and common practice leave it open:

- Stops are strict, h < H. All tests lie on the lattice t = k/(N 2^M); the hit is the first lattice point known inside.
- A search that stops nowhere, or at h = 0, hits the polygon itself if its fragment lies over it (hit_index N 2^M,
  linear_index -1); any other fragment is discarded. So is a hit in front of the near plane.
- steep_margin of a hit on the polygon is abs(0 - 0 - delta); of a discarded fragment NaN; of relief mapping, which knows no
  walls, inf. Comparisons whose h is exactly 0 or 1 are left out of march.margin by value.
- Gradients are central differences one texel apart, H(u + 1/W, v) - H(u - 1/W, v); a difference below 2^-16 counts as 0. On
  a steep hit with a facade its normal wins over the normal map's.
- All compared systems draw the base face alone, whatever `faces` says. Relief mapping compares d >= D, as its
  authors' shader does, and its hits lie at h = -d. `method="exact"` intersects the bilinear height field itself; its
  linear_index and hit_index are those of the first lattice points at or behind the hit, its margins stay infinite.
- In `interval="volume"` the border of the map is a wall, but normals come from the height map alone: a border wall takes
  the normal of the surface at its rim, or, where the map is flat there and a facade is given, faces the eye. An eye inside
  the solid sees nothing (its hit lies in front of the near plane).
- No margin is kept for three rare decisions: the threshold 2^-16 of the gradients, g = 0 on a steep hit, and the length of
  a shadow's stretch being positive, which is a matter of rounding for a hit on a border wall that faces the light.
- Vectors are normalized by dividing by their length, and the zero vector stays zero; specular powers are raised by
  repeated squaring, lowest bit first.
"""

from ibr_ref.displacement.bounds import bounding_points
from ibr_ref.displacement.culling import culled
from ibr_ref.displacement.inputs import Params, Scene
from ibr_ref.displacement.render import render

__all__ = ["Params", "Scene", "bounding_points", "culled", "render"]
