"""Splatting of depth images (Lee & Park 2006): reference images with depth, drawn as points from another camera.

`render(Scene, Params)` turns every valid pixel of a few reference images into a point, lights it in the vertex stage, and
draws it as a splat whose width is a rational law of the distance. `fit_splat_law` finds that law, which the paper sets by
hand; `coverage` says what a frame shows of its references, and where it has holes. What the paper compares with is here
too: `Params(method="software")` is the loop in software, `bake` and a constant width are fixed-function points; beyond it
`Params(shape="ellipse")` draws elliptical weighted averages, and `choose_references` chooses the images worth keeping.

**Stage arrays** (`frame.stages`). H x W is the picture, V the number of valid pixels of all images, in order of (image, row,
column). A dropped point, one outside w > 0, 0 <= z <= w in clip space, has width 0 and NaN for window and depth. Where no
splat covers a pixel, the winner is -1, the depth 1, the margin infinite. The stage normals is in `atlas.normal`.

| name | shape, dtype | what |
|---|---|---|
| atlas.rects | (N, 5) int32 | page, x, y, width, height of each image |
| atlas.color | one (h, w, 3) float64 a page | colours; 0 where nothing is and off the mask, as in the others |
| atlas.depth | one (h, w) float64 a page | metric depth along the view axis |
| atlas.normal | one (h, w, 3) uint8 a page | world-space normal, floor(127 n + 128.5); (0, 0, 0) off the mask |
| vertex.window | (V, 2) float64 | window x and y |
| vertex.depth | (V,) float64 | window depth |
| vertex.width | (V,) float64 | W_s, clamped, pixels |
| vertex.color | (V, 3) float64 | lit colour; without a light, the stored one |
| vertex.source | (V, 3) int32 | image, row, column |
| raster.splat | (H, W) int32 | the winning point; -1 none |
| raster.depth | (H, W) float64 | its window depth; 1 none |
| raster.overdraw | (H, W) int32 | all splats that cover the pixel |
| raster.margin | (H, W) float64 | second-smallest minus smallest depth of those; inf with fewer than two |

With `shape="ellipse"` the nearest splat is `raster.splat` and `vertex.width` the larger side of the ellipse's box; and:

| name | shape, dtype | what |
|---|---|---|
| vertex.covariance | (V, 3) float64 | xx, xy, yy of the Gaussian in the window, square pixels: `footprint.py` |
| vertex.amplitude | (V,) float64 | its weight at the centre, in (0, 1] |
| vertex.distance | (V,) float64 | along the view axis, of which the depth tolerance is a share |
| raster.weight | (H, W) float64 | sum of the weights that are averaged; 0 none |
| raster.blended | (H, W) int32 | how many splats these are |

**Settled here**, where the paper and common practice leave it open:

- d is the distance from the eye to the point; of an orthographic camera, which has no eye, that along the view axis.
- The denominator of the law must be positive for every point that is not dropped; then the width is clamped.
- A point whose centre lies outside the picture is drawn, as its splat may reach in (OpenGL culls point sprites there).
- Normals: of the two neighbours along an axis of the image the one nearer in depth counts, right or below on a tie; it must
  lie on the mask and within 5 % of the depth. A normal at right angles to the line of sight stays as the cross product
  (right or left, then below or above) has it.
- 8-bit normals have 128 for zero: with the paper's [-1, 1] to [0, 255] a component of 0 lies on a rounding boundary, and a
  fifth of the codes hang on the last bit of the arithmetic.
- An eye or a light at infinity is a unit vector and is not normalized again.
- On a tie in depth the point that comes first wins; a splat at depth 1 covers pixels (overdraw) and never wins.
- Whatever the images, the same picture comes out for any number of threads: a band of rows belongs to one of them.
- The law is fitted to the tau-quantile (0.95) of the widths that the points need, each at most 1.5 times what a surface that
  faces both cameras would need there: grazing surfaces stretch without limit. `size_law.py` says more.
- Ellipses are those of the reference pixels' own Gaussians on the tangent plane (`footprint`), not discs of one radius; the
  covered pixels are those within `cutoff` standard deviations of the centre, which is snapped; no splat is left out because
  it faces away. Their sums run in submission order.

**For ports**: a GL port that flips the rows on read-back turns the half-open rule of the squares upside down; one that
negates clip y agrees. Point sprites clamp widths, may snap them, and are culled by their centre; quads do not. The normals
are also an input: hand your port ours (`atlas.normal`, 8 bits), and judge its own by interval.
"""

from ibr_ref.splatting.baking import bake
from ibr_ref.splatting.coverage import Coverage
from ibr_ref.splatting.culling import culled
from ibr_ref.splatting.inputs import Params, Scene
from ibr_ref.splatting.measures import bounds, coverage, fit_splat_law
from ibr_ref.splatting.render import render
from ibr_ref.splatting.selection import Selection, choose_references
from ibr_ref.splatting.size_law import SplatLaw

__all__ = [
    "Coverage",
    "Params",
    "Scene",
    "Selection",
    "SplatLaw",
    "bake",
    "bounds",
    "choose_references",
    "coverage",
    "culled",
    "fit_splat_law",
    "render",
]
