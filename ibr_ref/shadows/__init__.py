"""Shadows by image warping (Kang & Ihm 2002): the map for an object's place is warped from nine that were made beforehand.

`maps = prepare(Scene, Params)` renders the nine maps of the caster alone and places their control points; `render(Scene,
Params, maps=maps)` draws a frame for any offset of the caster: six warps (or three) a light sample, however many triangles
the caster has. `method="direct"` renders a map for every sample instead; `method="grid"` takes n x n maps made beforehand
(`prepare_grid`) without a warp, raw or compressed by Haar wavelets. `shadow_maps` gives the maps alone. `render_soft(Scene,
SoftParams)` softens the shadow by other ways than samples of the light, to compare with: rays, a convolution, and
percentage-closer filtering (`help(ibr_ref.shadows.soft)`).

The caster's vertices stand at v + x a + y b for the offset (x, y). For a light sample at l the object is at
(x, y) - (l - centre) on the two axes, and the light looks from l in the centre's directions, bit for bit.

**Stage arrays** (`frame.stages`). H x W is the picture, S x S a map, R x C a grid. With more than one light sample every
warp.* and project.* array has a leading axis of samples. Where no surface is, project.* is 0, 0, inf, inf.

| name | shape, dtype | what |
|---|---|---|
| maps.positions | (3, 3, 2) float64 | the object's offsets for the nine maps, [j, i] = (x_i, y_j) |
| maps.depths | (3, 3) float64 | the caster's depths in them; only with interpolation="projective" |
| maps.image | (3, 3, S, S) float64 | the maps: coverage, or window depth (1 where empty) |
| controls | (3, 3, R, C, 2) float64 | control points (u, v) in [0, 1]^2 of the map |
| warp.cell | (2,) int32 | cell of the positions that holds the object, x first |
| warp.fraction | (2,) float64 | s and t in the cell |
| warp.shares | (3,) float64 | s of the upper row, s of the lower one, and t; only with interpolation="projective" |
| warp.row_grids | (2, R, C, 2) float64 | lerp(G00, G10, s) and lerp(G01, G11, s), by the rows' own shares if there are |
| warp.rows | (2, S, S) float64 | top and bottom |
| warp.grid | (R, C, 2) float64 | lerp of the row grids by t, or by its share |
| warp.image | (S, S) float64 | the map that is projected; the only array before project.* for "direct" and "grid" |
| project.coord | (H, W, 3) float64 | (s, t, r), t downwards, r clamped to [0, 1] |
| project.shadow | (H, W) float64 | 0 lit to 1 |
| project.margin | (H, W) float64 | distance of a comparison of depths from its other outcome; inf without one |
| project.texel_margin | (H, W) float64 | distance to the next texel's edge, in texels, on the nearer axis |
| accumulate.shadow | (H, W) float64 | the sum of all samples, each times 1/N |

**Settled here**, where the paper and common practice leave it open:

- Control points are registered (`shadows.automatic`): 9 or 4 training places in each cell of the nine positions, damped
  Gauss-Newton steps, coarse to fine; "fast" takes a second for nine maps of 256 x 256, "best" about ten. The rows of a
  registered grid may go across instead of downwards: its border is the map's all the same. Nothing folds at any place, by
  the Bernstein coefficients of all areas. What is found is compared with "bounds" and "identity" ("best": with "fast" too)
  and the nearest map, at 32 or 128 places that served neither, and taken where it is better beyond chance (`selection`);
  `maps.placement` says what was taken and what it reached there. The same bits on one machine; between machines only a
  logarithm, in the test that a step must pass, may differ. `maps.save` keeps what was made.
- interpolation="projective" (not the paper's): a share s' = s w1 / ((1 - s) w0 + s w1) in place of s, w the depth of the
  middle of the caster's bounding box along the light's view axis in the two maps; for t the w between the ends of the two
  rows. Exact for what lies at that depth. Grids, mixes and "nearest" all take the shares. Points are registered for the
  pace of the parameters; any pace can be drawn with them.
- Maps of k x k samples are masks of k S x k S, snapped to 1/256 of their own pixels, and counted; masks have no depth test.
- Warps draw triangles as everything here does: corners S G' snapped to 1/256 texel, exact integer edge functions, top-left
  rule, both orientations; attributes from the snapped corners, texture coordinates as they are. So a warp from a grid to
  itself leaves the image (within rounding) if the grid is on that lattice: automatic placements are.
- A light sample's place is centre + (g_i a + g_j b), g = 2/3; its displacement is place - centre, on the axes by their Gram
  matrix: they need be neither unit vectors nor at right angles. The focal length is the same in x and y to the last bit.
- On the middle line the object is in the upper cell; fraction 0.5 is nearer to the second image.
- `direct` renders the caster at its offset as the sample itself sees it, not moved back to the centre.
- The border of the map, s or t exactly 0 or 1, belongs to it; q_w <= 0 is behind the light. What lies before the light's
  near plane or beyond its far one is compared with r clamped. coord is divided out behind the light too.
- texel_margin is about whole texels for bilinear fetches too, and beside the map as if texels went on; inf behind the light.
- In masks the caster's own fragments are lit; depths are compared there too, also warped ones.
- quantize=8 rounds r - bias without clamping it first; the margin is in units of depth (steps of the rounding, over 255).
  It does not concern masks, nor do pcf and bias.
- With accumulation="float" the last sum is clamped to 1: nine times 1/9 comes out an ulp above.
- Colours of vertices are varyings, a mesh's one colour is taken as it is. Triangles without an area have no normal.
- The maps of method="grid" go from end to end of the widened range; compressed ones are clamped to [0, 1] when decoded.
"""

from ibr_ref.scene import AreaLight
from ibr_ref.shadows.grid import MapGrid, prepare_grid
from ibr_ref.shadows.inputs import Params, Scene
from ibr_ref.shadows.prepared import Maps, prepare
from ibr_ref.shadows.render import render, shadow_maps
from ibr_ref.shadows.soft import SoftParams, render_soft

__all__ = [
    "AreaLight",
    "MapGrid",
    "Maps",
    "Params",
    "Scene",
    "SoftParams",
    "prepare",
    "prepare_grid",
    "render",
    "render_soft",
    "shadow_maps",
]
