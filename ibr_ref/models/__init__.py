"""Built-in inputs, made by formula: the same bits on every machine.

For displacement mapping `box()` is the paper's figure 6, `city(seed)` a town in the spirit of its figures 15 and 16,
`city_blocks(seed, count)` the same town as a scene of many polygons, `buildings(seed)` the list of the wings that the town
is drawn from.

Meshes, each of closed parts wound outward: `kettle()`, `chair()` and `horse()` with 1,152, 1,464 and 5,804 triangles, as
many as the teapot, the chair and the cow of the shadows' tables have polygons; `sphere()` and `knot()`.

`depth_rig(mesh, count)` takes the reference images of splatting of any mesh, `depth_image(mesh, camera)` one from where
you like: the truth that a splatted view can be held against. `shadow_stage(caster)` is a scene for shadows around any mesh,
`shadow_ensemble` one of several, under several lights.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ibr_ref.models.box import box
from ibr_ref.models.chair import chair
from ibr_ref.models.city import city, city_blocks
from ibr_ref.models.city_plan import buildings
from ibr_ref.models.depth_rig import depth_image, depth_rig
from ibr_ref.models.horse import horse
from ibr_ref.models.kettle import kettle
from ibr_ref.models.knot import knot
from ibr_ref.models.sphere import sphere

if TYPE_CHECKING:
    from ibr_ref.models.stage_light import StageLight
    from ibr_ref.models.staged import shadow_ensemble, shadow_stage

__all__ = [
    "StageLight",
    "box",
    "buildings",
    "chair",
    "city",
    "city_blocks",
    "depth_image",
    "depth_rig",
    "horse",
    "kettle",
    "knot",
    "shadow_ensemble",
    "shadow_stage",
    "sphere",
]

_OF_SHADOWS = {"StageLight": "stage_light", "shadow_ensemble": "staged", "shadow_stage": "staged"}
"""In files of other names than theirs: a file that is imported takes the place of what is called like it."""


def __getattr__(name: str) -> Any:
    """Import on first use: whoever judges displacement must not wait for all of the shadows' kernels."""
    if name in _OF_SHADOWS:
        return getattr(import_module(f"ibr_ref.models.{_OF_SHADOWS[name]}"), name)
    raise AttributeError(f"module 'ibr_ref.models' has no attribute {name!r}")
