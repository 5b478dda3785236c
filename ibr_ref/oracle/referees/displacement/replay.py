"""Replay: each stage fed with the port's own arrays of the stages before, and what it hands on.

What a port did not hand in is the reference's, as far as it agrees with what it did: of all legal outcomes those that the
port's arrays fit stay, with the port's numbers in place of theirs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bounded import Bounded, exact, stored
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.referees.displacement.constants import Constants
from ibr_ref.oracle.referees.displacement.hits import CHUNK, Hits, joined_hits, no_hits, window_depth
from ibr_ref.oracle.referees.displacement.image import Candidates, candidates_of
from ibr_ref.oracle.referees.displacement.raster import Fragments, fragments_of
from ibr_ref.oracle.referees.displacement.shown import Shades
from ibr_ref.oracle.referees.displacement.vertex import triangles_of

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]

ARRAYS = {
    "vertex": ("vertex.patch", "vertex.clip"),
    "raster": ("raster.face", "raster.patch_id", "raster.patch"),
    "march": ("march.linear_index", "march.hit_index", "march.hit", "march.height_before", "march.steep"),
    "shade": ("shade.albedo", "shade.normal", "shade.lit"),
}
"""What is compared in each stage, in order of computation; besides, in shade the colours of what is shown, and in resolve
depth and background."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Port:
    """A port's arrays, one row a pixel, with the case that they answer."""

    case: Case
    device: Device
    handed: Handed

    @property
    def pixels(self) -> int:
        """Of the picture."""
        camera = self.case.scene.camera
        return int(camera.width * camera.height)

    @property
    def candidates(self) -> Candidates:
        """What the case alone allows."""
        return candidates_of(self.case, self.device)

    @property
    def constants(self) -> list[Constants]:
        """Of each polygon."""
        return self.candidates.constants

    def names(self, stage: str) -> tuple[str, ...]:
        """The stage's arrays that were handed in."""
        return tuple(name for name in ARRAYS[stage] if name in self.handed)

    def has(self, *names: str) -> bool:
        """Whether all of them were handed in."""
        return all(name in self.handed for name in names)

    def floats(self, name: str) -> Floats:
        """(pixels,) or (pixels, 3)."""
        return np.asarray(self._rows(np.asarray(self.handed[name])), np.float64)

    def ints(self, name: str) -> Ints:
        """(pixels,)."""
        return np.asarray(self._rows(np.asarray(self.handed[name])), np.int64)

    def _rows(self, array: Any) -> Any:
        return array.reshape(self.pixels, *array.shape[2:])

    def agreement(self, name: str, pixel: Ints, legal: Bounded | Ints | Bools) -> Bools:
        """Whether the port's numbers at pixels are those of an outcome."""
        if isinstance(legal, Bounded):
            allowed = legal.allows(self.floats(name)[pixel])
            return allowed if allowed.ndim == 1 else np.asarray(allowed.all(axis=1))
        return np.asarray(self.ints(name)[pixel] == legal, np.bool_)


def raster_input(port: Port) -> tuple[Fragments, tuple[str, ...]]:
    """The candidates of the port's own vertices, where it has as many as the reference."""
    faces = port.candidates.faces
    count = sum(len(each.patch.value) for each in faces)
    names = port.names("vertex")
    if not names or any(len(port.handed[name]) != count for name in names):
        return port.candidates.fragments, ()
    ends = np.cumsum([len(each.patch.value) for each in faces])[:-1]
    for name in names:
        field = name.partition(".")[2]
        parts = np.split(np.asarray(port.handed[name], np.float64), ends)
        changed: list[dict[str, Any]] = [
            {field: stored(part, port.device, getattr(own, field))} for part, own in zip(parts, faces, strict=True)
        ]
        faces = [replace(f, **change) for f, change in zip(faces, changed, strict=True)]
    camera = port.case.scene.camera
    with np.errstate(all="ignore"):  # a port's vertices may be anything
        fragments = fragments_of([triangles_of(each) for each in faces], port.device, camera.width, camera.height)
    return fragments, names


def march_input(port: Port, candidates: Fragments) -> tuple[Fragments, Bools]:
    """The fragments that the port marched from, and the pixels without one."""
    names = port.names("raster")
    if len(names) == len(ARRAYS["raster"]):
        face, polygon, point = port.ints(names[0]), port.ints(names[1]), port.floats(names[2])
        usable = (face >= 0) & (face <= 5) & (polygon >= 0) & (polygon < len(port.constants))
        pixel = np.flatnonzero(usable & np.isfinite(point).all(axis=1))
        return Fragments(
            pixel=pixel,
            polygon=polygon[pixel],
            face=face[pixel],
            certain=np.ones(len(pixel), np.bool_),
            point=stored(point[pixel], port.device),
            depth=_face_depth(candidates, pixel, polygon[pixel], face[pixel], port.device),
        ), face < 0
    agrees = np.ones(len(candidates), np.bool_)
    for name in names:
        agrees &= port.agreement(name, candidates.pixel, raster_field(candidates, name))
    fragments = candidates.take(agrees)
    if "raster.patch" in names:
        point = port.floats("raster.patch")[fragments.pixel]
        fragments = replace(fragments, point=stored(point, port.device, fragments.point))
    if "raster.face" in names:
        return fragments, port.ints("raster.face") < 0
    return fragments, not_covered(candidates, port.pixels)


def _face_depth(candidates: Fragments, pixel: Ints, polygon: Ints, face: Ints, device: Device) -> Bounded:
    """Window depth of the faces, as the candidates have it; unknown where there is no such candidate."""

    def keys(p: Ints, q: Ints, f: Ints) -> Ints:
        return (p * (int(candidates.polygon.max(initial=0)) + 1) + q) * 6 + f

    value, error = np.zeros(len(pixel)), np.full(len(pixel), np.inf)
    if len(candidates):
        known = keys(candidates.pixel, candidates.polygon, candidates.face)
        order = np.argsort(known, kind="stable")
        wanted = keys(pixel, polygon, face)
        at = np.minimum(np.searchsorted(known[order], wanted), len(order) - 1)
        found = known[order][at] == wanted
        value[found], error[found] = (e[order[at[found]]] for e in (candidates.depth.value, candidates.depth.error))
    return Bounded(value, error, device)


def raster_field(fragments: Fragments, name: str) -> Bounded | Ints:
    """What the contract's array holds of the candidates."""
    fields: dict[str, Bounded | Ints] = {
        "raster.face": fragments.face,
        "raster.patch_id": fragments.polygon,
        "raster.patch": fragments.point,
    }
    return fields[name]


def not_covered(candidates: Fragments, pixels: int) -> Bools:
    """(pixels,) which may have no fragment at all."""
    result = np.ones(pixels, np.bool_)
    result[candidates.pixel[candidates.certain]] = False
    return result


def march_field(hits: Hits, name: str) -> Bounded | Ints | Bools:
    """What the contract's array holds of the outcomes."""
    return getattr(hits, name.partition(".")[2])  # type: ignore[no-any-return]


def shade_input(port: Port, hits: Hits) -> Hits:
    """The hits that the port shaded."""
    names = port.names("march")
    if port.has("march.hit_index", "march.hit", "march.steep") and (
        "raster.patch_id" in port.handed or len(port.constants) == 1
    ):
        return _ports_hits(port, hits)
    agrees = np.ones(len(hits), np.bool_)
    for name in names:
        agrees &= port.agreement(name, hits.pixel, march_field(hits, name))
    hits = hits.take(agrees & hits.kept)
    return _at(port, hits, port.floats("march.hit")[hits.pixel]) if "march.hit" in names else hits


def _ports_hits(port: Port, hits: Hits) -> Hits:
    index, point = port.ints("march.hit_index"), port.floats("march.hit")
    several = "raster.patch_id" in port.handed
    polygon = port.ints("raster.patch_id") if several else np.zeros(port.pixels, np.int64)
    usable = (index >= 0) & np.isfinite(point).all(axis=1) & (polygon >= 0) & (polygon < len(port.constants))
    pixel = np.flatnonzero(usable)
    depth = np.full(len(pixel), np.nan)
    if port.case.params.depth == "polygon":
        known = hits.take(hits.kept)
        face_depth = _face_depth_of_hits(known, pixel, polygon[pixel], port.device)
    else:
        face_depth = Bounded(depth, depth, port.device)
    count, device = len(pixel), port.device
    ours = Hits(
        pixel=pixel,
        polygon=polygon[pixel],
        face=np.zeros(count, np.int64),
        certain=np.ones(count, np.bool_),
        point=exact(np.zeros((count, 3)), device),
        linear_index=np.zeros(count, np.int64),
        hit_index=index[pixel],
        hit=stored(point[pixel], device),
        height_before=exact(np.zeros(count), device),
        steep=port.ints("march.steep")[pixel] != 0,
        depth=face_depth,
    )
    return _at(port, ours, point[pixel])


def _face_depth_of_hits(hits: Hits, pixel: Ints, polygon: Ints, device: Device) -> Bounded:
    """Depths of the faces that were hit: any of them at the pixel, all of which lie in one another's bounds."""
    value, error = np.zeros(len(pixel)), np.full(len(pixel), np.inf)
    at = {(p, q): i for i, (p, q) in enumerate(zip(hits.pixel.tolist(), hits.polygon.tolist(), strict=True))}
    for i, key in enumerate(zip(pixel.tolist(), polygon.tolist(), strict=True)):
        if key in at:
            value[i], error[i] = hits.depth.value[at[key]], hits.depth.error[at[key]]
    return Bounded(value, error, device)


def _at(port: Port, hits: Hits, point: Floats) -> Hits:
    """The hits at the port's own points, with the depths that belong to them."""
    hits = replace(hits, hit=stored(point, port.device))
    if port.case.params.depth == "polygon":
        return hits
    return by_polygon(port, hits, _redepthed)


def _redepthed(constants: Constants, hits: Hits) -> Hits:
    _, depth = window_depth(constants, [hits.hit[:, k] for k in range(3)])
    return replace(hits, depth=depth)


def by_polygon(port: Port, hits: Hits, change: Callable[[Constants, Hits], Hits]) -> Hits:
    """Hits changed with the constants of their polygons, some thousands at a time."""
    parts = []
    for polygon, each in enumerate(port.constants):
        mine = np.flatnonzero(hits.polygon == polygon)
        parts += [change(each, hits.take(mine[i : i + CHUNK])) for i in range(0, len(mine), CHUNK)]
    return joined_hits(parts) if parts else no_hits(port.candidates.fragments)


def shade_field(shades: Shades, name: str) -> Bounded | Bools:
    """What the contract's array holds of the shades."""
    return getattr(shades, name.partition(".")[2])  # type: ignore[no-any-return]


def light_input(port: Port, hits: Hits, shades: Shades) -> Shades:
    """The surfaces that the port lit."""
    names = port.names("shade")
    if len(names) == len(ARRAYS["shade"]):
        albedo, normal = port.floats("shade.albedo"), port.floats("shade.normal")
        usable = np.isfinite(albedo[hits.pixel]).all(axis=1) & np.isfinite(normal[hits.pixel]).all(axis=1)
        index = np.flatnonzero(usable)
        pixel = hits.pixel[index]
        return Shades(
            hit=index,
            albedo=stored(albedo[pixel], port.device),
            normal=stored(normal[pixel], port.device),
            lit=port.ints("shade.lit")[pixel] != 0,
        )
    pixel = hits.pixel[shades.hit]
    agrees = np.ones(len(pixel), np.bool_)
    for name in names:
        agrees &= port.agreement(name, pixel, shade_field(shades, name))
    shades = shades.take(agrees)
    for field in ("albedo", "normal"):
        if f"shade.{field}" in names:
            numbers = port.floats(f"shade.{field}")[hits.pixel[shades.hit]]
            change: dict[str, Any] = {field: stored(numbers, port.device)}
            shades = replace(shades, **change)
    return shades
