"""Splatting of depth images (Lee & Park 2006): reference images with depth, drawn as points from another camera.

`render(Scene, Params)` turns every valid pixel of a few reference images into a point, lights it in the vertex stage,
and draws it as a splat whose width is a rational law of the distance. `fit_splat_law` finds that law, which the paper
sets by hand; `coverage` says what a frame shows of its references, and where it has holes. What the paper compares with
is here too: `Params(method="software")` is the loop in software, `bake` and a constant width are fixed-function points;
beyond it `Params(shape="ellipse")` draws elliptical weighted averages, and `choose_references` chooses the images worth
keeping.

`ibr-ref method splatting` prints the method, stage by stage: formulas, ties, every array with shape, dtype and
"nothing", and what the paper leaves open (`method.md` beside this file). `contract.STAGES` is the table of the arrays.
The same picture comes out for any number of threads: a band of rows belongs to one of them.
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
