"""shadows/method.md: shadows by image warping, and the methods that the paper compares with, in plain loops.

`stages, color, depth = render(scene, params, controls)`. The controls are an input, (3, 3, R, C, 2).

Where the page leaves the bits open, this is what the twin does:

Light
 1. Tangent of half the field of view: rounded once from decimals; focal length 1 / tan, both coordinates (square).
 2. View: right = unit(forward x up) from the forward direction before it is normalized; up = right x forward;
    translation -(axis . position). The same as the camera's `look_at`.
 3. "Directions stay": a sample's view has the centre's three axes, bit for bit, and only its translation is new, from
    the sample's position. (target + d) - (position + d) is not formed.
 4. A sample's position is centre + (g_i a + g_j b), g = 2.0 / 3.0 rounded; its displacement is position - centre,
    brought onto the axes. The centre of a list of positions is `light.position`.
 5. Coordinates on the axes (light, displacement) solve the Gram system, so the axes need be neither unit vectors nor
    orthogonal: ((b.b)(v.a) - (a.b)(v.b)) / ((a.a)(b.b) - (a.b)(a.b)), likewise y.
Maps
 6. The range is widened by the same amount at both ends: the largest |displacement| on that axis. A list of one
    position off the centre widens too.
 7. The middle of a range is (low + high) / 2, of the widened one.
 8. The caster stands at (v + x a) + y b.
 9. The nine maps are seen from the light's centre. Coverage of k x k samples: a mask of kS x kS, snapped to 1/256 of
    *its* pixels, and the count over k k. A mask has no depth test: a fragment at depth 1 counts. `map_samples` does
    not touch depth maps.
Warp
10. Window positions of control points are u S and v S, snapped; no detour over clip space. Weights are the integer edge
    functions over their sum. Interpolated grids are not snapped before they serve as texture coordinates.
11. The object's place o - d: not clamped into the range (rounding is monotonic: it cannot leave the widened range).
    Nearer: fraction < 0.5 the first, at 0.5 the second.
12. The mix is a (1 - f) + b f, also for f = 0. Outside the mesh the empty value takes part in the mix.
Surface
13. Drawn are the receivers in order, then the caster: on equal depths the receiver stays, and is not the caster's own.
14. World position and vertex colours are varyings; one colour for the mesh is taken as it is, not interpolated.
Project
15. All four terms of each row are summed, zeros too. coord is divided out also behind the light (q_w < 0), by IEEE
    rules at q_w = 0; behind is q_w <= 0. The border of the map (s or t exactly 0 or 1) belongs to it.
16. Nothing in front of the light's near plane, or beyond its far one, is left out: r is clamped, then compared.
17. The caster's own fragments are lit in mask content only; in depth content they are compared, with `warp` too.
18. texel_margin is about the edges of whole texels (multiples of 1/S), for mask and pcf too, and outside the map as if
    texels went on; infinite behind the light. margin is infinite for mask, outside the map and behind the light.
19. quantize: r - bias below 0 is not clamped first. The margin is in units of depth: steps of floor(255 x + 0.5)
    divided by 255. Masks are not quantized.
Accumulate
20. sum + shadow (1/N), in sample order; with "float" the last sum is clamped to 1, above which rounding may carry it.
    "unorm8": alpha = round(1/N); each sum is clamped to 1, then rounded.
Resolve
21. brightness = ambient + ((1 - ambient) (1 - shadow)) max(0, n.l); n from the triangle's world vertices, turned where
    n . (eye - p) < 0, p the fragment; l the unit vector to `light.position`. No clamp of the colour.
Methods
22. `direct`: the caster at its true offset, seen from each sample's own position (not moved back to the centre).
    Its maps are `warp.image`; there is no other `warp.*`, no `maps.*`, no `controls`.
23. `grid`: evenly spaced from end to end of the widened range, ends included; seen from the centre; nearer as in 11.
    `params.grid_size` (32) and `params.grid_mix` (True) if they exist. Its maps are `warp.image` too. No wavelets.
Raster (maps and surface, shared with the displacement's twin)
24. A cut edge is lerp(inside, outside, d_in / (d_in - d_out)); a corner on the plane is inside. Only triangles with
    |x| > 2^21/width w or |y| > 2^21/height w are cut at that guard band too, after near and far.
25. varying = (((E0 a0)/w0 + (E1 a1)/w1) + (E2 a2)/w2) / ((E0/w0 + E1/w1) + E2/w2); depth with z/w per corner.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .shadow_light import Pair, Sample, camera_at, light_samples_of
from .shadow_maps import grid_map, map_positions, prepared_maps, rendered_map
from .shadow_project import Projected, project
from .shadow_surface import Surface, resolved_color, visible_surface
from .vectors import vec3, vec4
from .warp import warped_map

Stages = dict[str, np.ndarray]


def plain_offset(scene: Any) -> Pair:
    """Where the object stands."""
    return float(scene.offset[0]), float(scene.offset[1])


def offset_seen_from(scene: Any, sample: Sample) -> Pair:
    """The object moved the opposite way from the light sample: o - (l_i - l_centre) on the two axes (stage accumulate)."""
    x, y = plain_offset(scene)
    return x - sample.displacement[0], y - sample.displacement[1]


def per_sample(arrays: list[Any]) -> np.ndarray:
    """Stacked along a leading sample axis, which is left out for a single sample (stage project)."""
    return np.array(arrays) if len(arrays) > 1 else np.array(arrays[0])


# --- 1. maps, 2. controls, 3. warp -----------------------------------------------------------------------------------


def prepare(scene: Any, params: Any) -> tuple[np.ndarray, np.ndarray]:
    """(positions (3, 3, 2), images (3, 3, S, S)) of the nine maps."""
    positions = map_positions(scene, light_samples_of(scene, params))
    return positions, prepared_maps(scene, params, positions)


def caster_depths(scene: Any, positions: Any) -> np.ndarray:
    """(3, 3) depth of the middle of the caster's box along the light's view axis, at the nine offsets."""
    vertices = [vec3(vertex) for vertex in np.asarray(scene.caster.vertices)]
    middle = tuple((min(v[k] for v in vertices) + max(v[k] for v in vertices)) / 2.0 for k in range(3))
    a, b = vec3(scene.offset_axes[0]), vec3(scene.offset_axes[1])
    backwards = camera_at(scene.light, vec3(scene.light.position)).view_from_world[2]
    depths = np.empty((3, 3))
    for j in range(3):
        for i in range(3):
            x, y = float(positions[j, i, 0]), float(positions[j, i, 1])
            p = tuple((middle[k] + x * a[k]) + y * b[k] for k in range(3))
            depths[j, i] = -(backwards[0] * p[0] + backwards[1] * p[1] + backwards[2] * p[2] + backwards[3])
    return depths


def warp_stages(scene: Any, params: Any, samples: list[Sample], controls: Any, maps: Any) -> Stages:
    """The stages "maps.*", "controls" and "warp.*" of the method "warp"."""
    positions, images = prepare(scene, params) if maps is None else maps
    depths = caster_depths(scene, positions) if getattr(params, "interpolation", "linear") == "projective" else None
    warps = [
        warped_map(offset_seen_from(scene, sample), positions, images, controls, params, depths) for sample in samples
    ]
    stages = {
        "maps.positions": np.array(positions, dtype=np.float64),
        "maps.image": np.array(images, dtype=np.float64),
        "controls": np.array(controls, dtype=np.float64),
    }
    if depths is not None:
        stages["maps.depths"] = depths
    for name in warps[0]._fields:
        if name == "shares" and depths is None:
            continue
        stages[f"warp.{name}"] = per_sample([getattr(warp, name) for warp in warps])
    return stages


def image_stages(scene: Any, params: Any, samples: list[Sample], controls: Any, maps: Any) -> tuple[Stages, list[Any]]:
    """(stages before projection, one map (S, S) for each light sample), by the method."""
    if params.method == "warp":
        stages = warp_stages(scene, params, samples, controls, maps)
        images = stages["warp.image"]
        return stages, list(images) if len(samples) > 1 else [images]
    if params.method == "direct":
        made = [rendered_map(scene, params, plain_offset(scene), sample.position) for sample in samples]
    elif params.method == "grid":
        count, mix = int(getattr(params, "grid_size", 32)), bool(getattr(params, "grid_mix", True))
        made = [grid_map(scene, params, samples, offset_seen_from(scene, s), count, mix) for s in samples]
    else:
        raise ValueError(f"method: {params.method!r} is not one of 'warp', 'direct', 'grid'")
    return {"warp.image": per_sample(made)}, made


# --- 4. project ------------------------------------------------------------------------------------------------------


def project_samples(scene: Any, params: Any, surface: Surface, samples: list[Sample], images: Any) -> list[Projected]:
    """Each sample's map, projected from where the sample is."""
    return [
        project(surface, image, camera_at(scene.light, sample.position), params)
        for sample, image in zip(samples, images, strict=True)
    ]


# --- 5. accumulate ---------------------------------------------------------------------------------------------------


def rounded(c: float) -> float:
    """The nearest 8-bit value."""
    return math.floor(255.0 * min(max(c, 0.0), 1.0) + 0.5) / 255.0


def accumulated(shadows: list[float], accumulation: str) -> float:
    """The shadows of one pixel, each weighted by alpha = 1/N and added in order."""
    if accumulation not in ("float", "unorm8"):
        raise ValueError(f"accumulation: {accumulation!r} is neither 'float' nor 'unorm8'")
    alpha = 1.0 / len(shadows)
    if accumulation == "unorm8":
        alpha = rounded(alpha)
    total = 0.0
    for shadow in shadows:
        total = total + shadow * alpha
        if accumulation == "unorm8":
            total = rounded(total)
    return min(total, 1.0)


def accumulate(shadows: list[np.ndarray], accumulation: str) -> np.ndarray:
    """The stage "accumulate.shadow" (H, W), from one (H, W) a sample."""
    height, width = shadows[0].shape
    result = np.zeros((height, width))
    for row in range(height):
        for column in range(width):
            result[row, column] = accumulated([float(shadow[row, column]) for shadow in shadows], accumulation)
    return result


# --- 6. resolve ------------------------------------------------------------------------------------------------------


def resolve(scene: Any, surface: Surface, shadow: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(color (H, W, 3), depth (H, W)): the background, at depth 1, where no surface is."""
    height, width = len(surface), len(surface[0])
    color = np.empty((height, width, 3))
    depth = np.ones((height, width))
    eye = vec4(scene.camera.eye)
    for row, line in enumerate(surface):
        for column, fragment in enumerate(line):
            if fragment is None:
                color[row, column] = vec3(scene.background)
                continue
            color[row, column] = resolved_color(fragment, float(shadow[row, column]), scene, eye)
            depth[row, column] = fragment.depth
    return color, depth


def render(scene: Any, params: Any, controls: Any = None, maps: Any = None) -> tuple[Stages, np.ndarray, np.ndarray]:
    """(stages, color, depth) of a frame; `maps`: (positions, images) made by `prepare`, None to make them here."""
    samples = light_samples_of(scene, params)
    stages, images = image_stages(scene, params, samples, controls, maps)
    surface = visible_surface(scene)
    projections = project_samples(scene, params, surface, samples, images)
    for name in projections[0]._fields:
        stages[f"project.{name}"] = per_sample([getattr(projection, name) for projection in projections])
    shadow = accumulate([projection.shadow for projection in projections], str(params.accumulation))
    stages["accumulate.shadow"] = shadow
    color, depth = resolve(scene, surface, shadow)
    return stages, color, depth
