"""What the camera may see: every fragment that may be what a pixel shows, and whether it may show none."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.accept.bounded import Bounded, opposite
from ibr_ref.oracle.accept.coverage import Fragments
from ibr_ref.oracle.arithmetic.decisions import joined
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.referees.shadows.drawing import Pass, Varyings, names_of, pixels_of, weights_inside
from ibr_ref.oracle.referees.shadows.model import Model


@dataclass(frozen=True, eq=False)
class Objects:
    """Receivers and caster in world space, in the order in which they are drawn."""

    points: list[Number]
    """x, y, z (V,)."""
    names: Ints
    """(V,) one number for vertices of an object that are one point."""
    triangles: Ints
    """(T, 3)."""
    caster: Bools
    """(T,)."""
    colors: Number
    """(V, 3)."""
    plain: Bools
    """(T,) its mesh has one colour."""

    @classmethod
    def of(cls, model: Model) -> Objects:
        """Everything of a scene."""
        scene, meshes = model.case.scene, model.program.meshes()
        sources = [*scene.receivers, scene.caster]
        sizes = [len(colors) for _, colors, _ in meshes]
        starts = np.cumsum([0, *sizes[:-1]])
        counts = [len(triangles) for _, _, triangles in meshes]
        return cls(
            [joined([model.machine.of(world[k]) for world, _, _ in meshes]) for k in range(3)],
            np.concatenate([names_of(mesh.vertices) + start for mesh, start in zip(sources, starts, strict=True)]),
            np.concatenate([np.asarray(t, np.int64) + start for (_, _, t), start in zip(meshes, starts, strict=True)]),
            np.repeat([False] * len(scene.receivers) + [True], counts),
            joined([model.machine.of(colors) for _, colors, _ in meshes]),
            np.repeat([np.asarray(mesh.color).ndim == 1 for mesh in sources], counts),
        )


@dataclass(frozen=True, eq=False)
class Seen:
    """Fragments (n,) that may be shown, and what the pixels (H W,) may be besides."""

    pixel: Ints
    triangle: Ints
    """Among all of the scene."""
    caster: Bools
    depth: Bounded
    world: list[Bounded]
    color: list[Bounded]
    cosine: Bounded
    """max(0, n . l) with the normal on the side that the reference takes."""
    other: Bounded
    """The same on the other side."""
    edge_on: Bools
    """Either side is legal."""
    empty: Bools
    """(H W,) may show nothing."""
    wild: Bools
    """(H W,) may show a triangle of which it is not certain whether a clip plane cuts it."""
    shape: tuple[int, int]

    @cached_property
    def first(self) -> Ints:
        """(H W,) by pixel the fragment that is shown if every decision falls as it does in exact arithmetic; -1 none."""
        result = np.full(len(self.empty), -1, np.int64)
        order = np.lexsort((self.triangle, self.depth.value, ~self.inside, self.pixel))
        fresh = np.r_[True, np.diff(self.pixel[order]) > 0] if len(order) else np.zeros(0, np.bool_)
        best = order[fresh]
        result[self.pixel[best]] = np.where(self.inside[best] | ~self.empty[self.pixel[best]], best, -1)
        return result

    inside: Bools
    """(n,) the pixel's centre is inside the triangle, in exact arithmetic."""

    def any_of(self, pixel: Ints, legal: Bools, nothing: Bools) -> Bools:
        """(H W,) whether one of the outcomes at pixels (n,), or nothing (H W,) where that may be, agrees."""
        result = (nothing & self.empty) | self.wild
        result[pixel[legal]] = True
        return result

    def among(self, pixels: Bools) -> Seen:
        """Only the fragments of some pixels (H W,)."""
        return self._only(pixels[self.pixel])

    def _only(self, kept: Bools) -> Seen:
        return replace(
            self,
            pixel=self.pixel[kept],
            triangle=self.triangle[kept],
            caster=self.caster[kept],
            depth=self.depth[kept],
            world=[axis[kept] for axis in self.world],
            color=[channel[kept] for channel in self.color],
            cosine=self.cosine[kept],
            other=self.other[kept],
            edge_on=self.edge_on[kept],
            inside=self.inside[kept],
        )

    def bounded(self) -> Seen:
        """Without fragments of which nothing is known, such as those of triangles seen edge on: their pixels are wild."""
        numbers = [self.depth, *self.world, *self.color, self.cosine, self.other]
        known = np.logical_and.reduce([np.isfinite(n.value + n.error) for n in numbers])
        if known.all():
            return self
        wild = self.wild.copy()
        wild[self.pixel[~known]] = True
        return replace(self._only(known), wild=wild)


def see(model: Model) -> Seen:
    """What the camera of a case may see."""
    camera, program, machine = model.case.scene.camera, model.program, model.machine
    width, height = int(camera.width), int(camera.height)
    objects = Objects.of(model)
    window = Pass(model, program.surface_raster(machine), width, height)
    vertices = [*program.to_clip(objects.points), *objects.points]
    painted = [Number(machine, np.ones(len(objects.names)))]
    if not (objects.plain.all() and program.right("colors")):
        painted += [objects.colors[:, k] for k in range(3)]
    with np.errstate(all="ignore"):
        cut = window.cut([model.bounded(x) for x in [*vertices, *painted]], objects.triangles, objects.names)
        found = window.cover(cut.x, cut.y)
        varyings, owned = window.varyings(cut), window.owners(found, cut.names)
        w = model.number(cut.w)
        depth = machine.depth(program.window_depth(varyings, found, model.number(cut.z), w))
        pixel = pixels_of(found, width)
        won = window.winners(pixel, owned.drawn, model.bounded(depth), owned.owner)
        shown = _only(found, won.possible)
        source = cut.source[shown.triangle]
        corners = [model.number(x) for x in cut.attributes]
        world = [model.bounded(x) for x in program.world(varyings, shown, w, corners[:3])]
        cosine, other, edge_on = _lit(model, objects, source, world)
        colors = _colors(model, objects, varyings, shown, (w, corners[3:]), source)
    seen = Seen(
        pixel=pixel[won.possible],
        triangle=source,
        caster=objects.caster[source],
        depth=model.bounded(program.read_back(depth))[won.possible],
        world=world,
        color=colors,
        cosine=cosine,
        other=other,
        edge_on=edge_on,
        empty=won.empty,
        wild=np.full(width * height, cut.wild),
        shape=(height, width),
        inside=weights_inside(shown),
    )
    return seen.bounded()


def _only(found: Fragments, kept: Bools) -> Fragments:
    return Fragments(**{field.name: getattr(found, field.name)[kept] for field in fields(found)})


def _colors(
    model: Model,
    objects: Objects,
    varyings: Varyings,
    shown: Fragments,
    corners: tuple[Number, list[Number]],
    source: Ints,
) -> list[Bounded]:
    """(n,) channels: of meshes with one colour as it is, which a port may interpolate all the same, else interpolated.

    corners: w, and the varyings: the number 1, of which the error is that of any constant, relative to it; and the channels,
    if some are painted.
    """
    w, (one, *channels) = corners
    constant = model.bounded(varyings.perspective(shown, w, [one])[0])
    flat = objects.colors[objects.triangles[source, 0]]
    plain = [model.bounded(flat[:, k]) for k in range(3)]
    plain = [p.widened(p.size * constant.error) for p in plain]
    if not channels:
        return plain
    found = [model.bounded(model.machine.of(c)) for c in model.program.colors(varyings, shown, w, channels)]
    if not model.program.right("colors"):
        return found
    return [p.where(objects.plain[source], v) for p, v in zip(plain, found, strict=True)]


def _normals(model: Model, objects: Objects) -> list[Number]:
    """x, y, z (T,); any direction where a triangle may have no area."""
    found = model.program.normals([p[objects.triangles] for p in objects.points])
    result = []
    for n in found:
        known = np.isfinite(n.value + n.deviation)
        error = np.where(known, n.deviation, opposite(model.device))
        result.append(Number(model.machine, np.nan_to_num(n.value), error))
    return result


def _lit(model: Model, objects: Objects, source: Ints, world: list[Bounded]) -> tuple[Bounded, Bounded, Bools]:
    """(n,) max(0, n . l), the same on the triangle's other side, and whether the eye may be on either."""
    normals, count, machine = _normals(model, objects), len(source), model.machine

    def run(origin: Ints) -> dict[str, Any]:
        lane = np.arange(len(origin))
        normal = [Number(machine, n.value[source[origin]], n.error[source[origin]], {}, lane) for n in normals]
        places = [model.number(axis[origin], lane, "world") for axis in world]
        return {"cosine": machine.of(model.program.cosine(normal, places))}

    found, _ = machine.follow(run, count)
    cosine, origin = model.bounded(found["cosine"]), found["origin"]
    with np.errstate(all="ignore"):
        exact = model.exact.cosine([n.value[source] for n in normals], [axis.value for axis in world])
    first, other, edge_on = np.arange(count), np.arange(count), np.zeros(count, np.bool_)
    forks = np.arange(count, len(origin))
    other[origin[forks]], edge_on[origin[forks]] = forks, True
    away = np.abs(cosine.value - np.asarray(exact)[origin])
    swap = edge_on & (away[other] < away[first])
    first, other = np.where(swap, other, first), np.where(swap, first, other)
    return cosine[first], cosine[other], edge_on
