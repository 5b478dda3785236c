"""The passes for several casters and lights: for each light and sample the union of the casters' shadows, then their sum."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.choices import MAPPED
from ibr_ref.io import Frame
from ibr_ref.scene import checks
from ibr_ref.shadows.automatic import Progress
from ibr_ref.shadows.ensemble import Ensemble
from ibr_ref.shadows.grid import MapGrid
from ibr_ref.shadows.inputs import Params
from ibr_ref.shadows.prepared import Maps, prepare
from ibr_ref.shadows.project import Lookup, Projected
from ibr_ref.shadows.render import grouped, images_of, lookup_of, per_sample, projected_from, surface_of
from ibr_ref.shadows.resolve import Lights, accumulate, resolve
from ibr_ref.shadows.samples import samples_of
from ibr_ref.shadows.surface import Surface

EnsembleMaps = Sequence[Sequence[Maps | MapGrid]]
"""[caster][light]."""


def prepare_ensemble(
    ensemble: Ensemble, params: Params | None = None, *, controls: str = "fast", progress: Progress | None = None
) -> list[list[Maps]]:
    """Nine maps for each caster and light, [caster][light]: what `prepare` makes of `ensemble.scene(caster, light)`."""
    params = Params() if params is None else params
    made: list[list[Maps]] = [[] for _ in ensemble.casters]
    for i, j in ensemble.pairs:
        with ensemble.naming(i, j):
            made[i].append(prepare(ensemble.scene(i, j), params, controls=controls, progress=progress))
    return made


def render_ensemble(
    ensemble: Ensemble,
    params: Params | None = None,
    *,
    maps: EnsembleMaps | None = None,
    stages: bool = True,
    rows: tuple[int, int] | None = None,
) -> Frame:
    """Draw receivers and casters under all lights.

    For each sample of a light a point is in the shadow of the caster that darkens it most: where shadows overlap they are
    no darker. Each light adds its share, and colours above 1 become 1. With one caster and one light the frame has the bits
    of `render`. maps: [caster][light], as `prepare_ensemble` makes them (for method="grid" `prepare_grid`); None: made here,
    at every call. rows: as in `render`.
    Stages: those of `render` for each pair, "light0.caster0.warp.image" and so on, and for each light
    "light0.union.shadow" (with an axis of samples, if there are several) and "light0.accumulate.shadow". Raises ValueError
    where `render` does, and for positions in place of a number of samples under several lights.
    """
    params = Params() if params is None else params
    _check(ensemble, params, maps)
    surface = surface_of(ensemble, rows)
    shadows: list[Floats] = []
    kept: dict[str, Any] = {}
    for light in range(len(ensemble.lights)):
        unions = _unions(ensemble, params, maps, light, surface, kept if stages else None)
        shadows.append(_sum(unions, params))
        if stages:
            kept.update(
                {f"light{light}.union.shadow": per_sample(unions), f"light{light}.accumulate.shadow": shadows[-1]}
            )
    lights = Lights(np.stack([light.arrays[0] for light in ensemble.lights]), np.asarray(ensemble.powers))
    background = np.asarray(ensemble.background)
    color = resolve(surface, np.stack(shadows), ensemble.camera.eye, lights, float(ensemble.ambient), background)
    if lights.powers.sum() > 1.0:  # otherwise no brightness can be above 1
        np.minimum(color, 1.0, out=color)
    return Frame(color=color, depth=surface.depth, stages=kept)


def _check(ensemble: Ensemble, params: Params, maps: EnsembleMaps | None) -> None:
    checks.choice("method", params.method, MAPPED)
    if len(ensemble.lights) > 1 and isinstance(params.light_samples, np.ndarray):
        found = f"{len(params.light_samples)} positions"
        raise checks.reject(
            "light_samples", found, "1 | 5 | 9 with several lights, each of which has its own positions"
        )
    wanted = [len(ensemble.lights)] * len(ensemble.casters)
    if maps is not None and [len(row) for row in maps] != wanted:
        raise checks.reject("maps", f"{[len(row) for row in maps]} of the casters", f"{wanted}, one for each light")


def _unions(
    ensemble: Ensemble,
    params: Params,
    maps: EnsembleMaps | None,
    light: int,
    surface: Surface,
    kept: dict[str, Any] | None,
) -> list[Floats]:
    """For each sample of a light the union (H, W) of the casters' shadows; their stages go into `kept`, if it is there."""
    lookup = lookup_of(ensemble, params, kept is not None)
    unions: list[Floats] = []
    for caster in range(len(ensemble.casters)):
        with ensemble.naming(caster, light):
            given = None if maps is None else maps[caster][light]
            projections, made = _projections(ensemble, params, given, (caster, light), surface, lookup)
        unions = unions or [np.zeros(surface.depth.shape) for _ in projections]
        for union, projected in zip(unions, projections, strict=True):
            np.maximum(union, projected.shadow, out=union)
        if kept is not None:
            made.update(grouped("project", Projected._fields, projections))
            kept.update({f"light{light}.caster{caster}.{name}": array for name, array in made.items()})
    return unions


def _projections(
    ensemble: Ensemble,
    params: Params,
    maps: Maps | MapGrid | None,
    pair: tuple[int, int],
    surface: Surface,
    lookup: Lookup,
) -> tuple[list[Projected], dict[str, Any]]:
    """One caster's maps projected from all samples of one light, and the stages up to that."""
    scene = ensemble.scene(*pair)
    samples = samples_of(scene, params)
    images, made = images_of(scene, params, samples, maps, lookup.keep)
    return [
        projected_from(scene.light, sample, image, surface, lookup)
        for sample, image in zip(samples, images, strict=True)
    ], made


def _sum(unions: Sequence[Floats], params: Params) -> Floats:
    """(H, W) of all samples, each with alpha = 1/N."""
    shadow = np.zeros(unions[0].shape)
    for union in unions:
        accumulate(shadow, union, len(unions), params.accumulation == "unorm8")
    np.minimum(shadow, 1.0, out=shadow)  # N times 1/N may come out an ulp above 1
    return shadow
