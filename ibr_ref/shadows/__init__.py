"""Shadows by image warping (Kang & Ihm 2002): the map for an object's place is warped from nine that were made beforehand.

`maps = prepare(Scene, Params)` renders the nine maps of the caster alone and places their control points;
`render(Scene, Params, maps=maps)` draws a frame for any offset of the caster: six warps (or three) a light sample,
however many triangles the caster has. `method="direct"` renders a map for every sample instead; `method="grid"` takes n
x n maps made beforehand (`prepare_grid`) without a warp, raw or compressed by Haar wavelets; `method="pcss"` softens one
map by the light's size, as percentage-closer soft shadows do. `shadow_maps` gives the maps alone. `render_soft(Scene,
SoftParams)` softens the shadow by ways to compare with: rays, and a convolution (`help(ibr_ref.shadows.soft)`).
`Ensemble`, `prepare_ensemble` and `render_ensemble` draw several casters under several lights.

`ibr-ref method shadows` prints the method, stage by stage: formulas, ties, every array with shape, dtype and "nothing",
and what the paper leaves open (`method.md` beside this file). `contract.STAGES` is the table of the arrays.

Automatic control points: "fast" takes a second for nine maps of 256 x 256, "best" about ten; `maps.save` keeps what was
made.
"""

from ibr_ref.scene import AreaLight
from ibr_ref.shadows.bounds import bounding_points
from ibr_ref.shadows.culling import culled, cut_by_light
from ibr_ref.shadows.ensemble import Caster, Ensemble
from ibr_ref.shadows.grid import MapGrid, prepare_grid
from ibr_ref.shadows.inputs import Params, Scene
from ibr_ref.shadows.prepared import Maps, prepare
from ibr_ref.shadows.render import render, shadow_maps
from ibr_ref.shadows.render_ensemble import prepare_ensemble, render_ensemble
from ibr_ref.shadows.soft import SoftParams, render_soft

__all__ = [
    "AreaLight",
    "Caster",
    "Ensemble",
    "MapGrid",
    "Maps",
    "Params",
    "Scene",
    "SoftParams",
    "bounding_points",
    "culled",
    "cut_by_light",
    "prepare",
    "prepare_ensemble",
    "prepare_grid",
    "render",
    "render_ensemble",
    "render_soft",
    "shadow_maps",
]
