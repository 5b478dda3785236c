"""Soft shadows by other ways than samples of the light: what nine samples, rendered or warped, are to be compared with.

`render_soft(Scene, SoftParams)` draws the same picture as `render`, with the caster's shadow by

- `method="traced"`: rays from every visible point to points all over the light (`traced`), the truth;
- `method="convolution"`: Soler & Sillion 1998 (`convolution`), which the paper names in section 1.

Both see what the masks of `render` see: the caster alone throws a shadow, and not upon itself. Stage arrays
(`frame.stages`): "soft.shadow" (H, W) of both; of "convolution" "soft.planes" (P,), the distances of the receivers' planes
from the light's, and "soft.maps" (P, S, S), the shadow on each. `render` with `method="pcss"` is a way that people port.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.choices import SOFT
from ibr_ref.io import Frame
from ibr_ref.scene import checks
from ibr_ref.shadows import convolution, maps, parallel
from ibr_ref.shadows.inputs import FINEST_MAP, LARGEST_MAP, Params, Scene
from ibr_ref.shadows.lattice import on_parallelogram
from ibr_ref.shadows.light_map import before_light
from ibr_ref.shadows.maps import MOST_SAMPLES
from ibr_ref.shadows.render import caster_from, surface_of
from ibr_ref.shadows.resolve import one_light, resolve
from ibr_ref.shadows.samples import samples_of
from ibr_ref.shadows.surface import Surface
from ibr_ref.shadows.traced import traced
from ibr_ref.shadows.vertex import place

READ_BY: dict[str, tuple[str, ...]] = {
    "rays": ("traced",),
    **dict.fromkeys(("map_size", "map_samples", "receiver_planes"), ("convolution",)),
}
"""Fields of `SoftParams` that only some methods read, and these."""
MOST_RAYS = 65536
MOST_PLANES = 64


@dataclass(frozen=True, kw_only=True, eq=False)
class SoftParams:
    """How the light's size is taken into account."""

    method: str = "traced"
    """`"traced"` or "convolution"."""
    rays: int = 610
    """Of "traced", from every point, 1 to 65536: what it says of a straight edge is right to about 2/rays."""
    map_size: int = 512
    """S >= 8, texels a side of the one map that "convolution" renders; it holds the caster and its penumbra."""
    map_samples: int = 1
    """k, 1 to 15, of "convolution": a texel is the coverage of k x k samples."""
    receiver_planes: int = 4
    """P, 1 to 64, of "convolution"."""

    def __post_init__(self) -> None:
        checks.choice("method", self.method, SOFT)
        wholes = {
            "rays": (1, MOST_RAYS),
            "map_size": (8, LARGEST_MAP),
            "map_samples": (1, MOST_SAMPLES),
            "receiver_planes": (1, MOST_PLANES),
        }
        for name, (low, high) in wholes.items():
            object.__setattr__(self, name, checks.whole(name, getattr(self, name), low=low, high=high))
        if self.map_size * self.map_samples > FINEST_MAP:
            raise checks.reject("map_size * map_samples", self.map_size * self.map_samples, f"<= {FINEST_MAP}")


def render_soft(scene: Scene, params: SoftParams | None = None, *, stages: bool = True) -> Frame:
    """Draw receivers and caster with the caster's soft shadow; stages as this module lists them.

    Raises ValueError where `render` does, and for a caster that is not wholly on one side of the light's plane.
    """
    params = SoftParams() if params is None else params
    samples_of(scene, Params())  # the light's centre is neither in the caster nor on a triangle
    surface = surface_of(scene)
    caster = place(np.asarray(scene.caster.vertices), scene.axes, np.asarray(scene.offset))
    kept = {"traced": _traced, "convolution": _convolved}[params.method](scene, params, surface, caster)
    lights, background = one_light(scene.light.arrays[0]), np.asarray(scene.background)
    shadows = kept["soft.shadow"][np.newaxis]
    color = resolve(surface, shadows, scene.camera.eye, lights, float(scene.ambient), background)
    return Frame(color=color, depth=surface.depth, stages=kept if stages else {})


def _traced(scene: Scene, params: SoftParams, surface: Surface, caster: Floats) -> dict[str, Any]:
    lights = on_parallelogram(*scene.light.arrays, params.rays)
    triangles = np.asarray(scene.caster.triangles)
    shadow = traced(surface.triangle, surface.varyings, caster_from(scene), caster, triangles, lights)
    return {"soft.shadow": shadow}


def _convolved(scene: Scene, params: SoftParams, surface: Surface, caster: Floats) -> dict[str, Any]:
    first, triangles = caster_from(scene), np.asarray(scene.caster.triangles)
    frame, window, receivers = _parallel(scene, surface, caster)
    view = parallel.view_of_caster(frame, window, caster, triangles)
    counts = maps.mask(view, np.zeros(2), params.map_size, params.map_samples)
    occluder, distance = maps.values(counts, params.map_samples), (window.near + window.far) / 2.0
    planes = convolution.plane_distances(receivers, distance, params.receiver_planes)
    images = convolution.convolved(occluder, frame, window, distance, planes)
    shadow = convolution.look_up(surface.triangle, surface.varyings, first, frame, window, distance, planes, images)
    return {"soft.planes": planes, "soft.maps": images, "soft.shadow": shadow}


def _parallel(scene: Scene, surface: Surface, caster: Floats) -> tuple[parallel.Frame, parallel.Window, Floats]:
    """The light's frame, a window around the caster, and the distances of all that is seen of the receivers."""
    frame, drawn, nearest = before_light(scene, caster)
    seen = (surface.triangle >= 0) & (surface.triangle < caster_from(scene))
    receivers = parallel.distances(frame, surface.varyings[seen][:, :3])
    farthest = float(receivers.max()) if len(receivers) else 0.0
    return frame, parallel.window_around(frame, drawn, max(farthest, nearest)), receivers
