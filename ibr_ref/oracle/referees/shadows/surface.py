"""What the camera may see: every fragment that may be what a pixel shows, and whether it may show none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.accept.bounded import Bounded, dot, exact, opposite, unit, uploaded
from ibr_ref.oracle.accept.coverage import Fragments, fragments
from ibr_ref.oracle.accept.seams import owners
from ibr_ref.oracle.accept.winners import winners
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.referees.shadows import places
from ibr_ref.oracle.referees.shadows.clipping import clipped
from ibr_ref.oracle.referees.shadows.maps import names_of
from ibr_ref.oracle.referees.shadows.transform import Lens, placed
from ibr_ref.oracle.referees.shadows.varyings import Triangles, linear, perspective


@dataclass(frozen=True, eq=False)
class Objects:
    """Receivers and caster in world space, in the order in which they are drawn."""

    points: list[Bounded]
    """x, y, z (V,)."""
    names: Ints
    """(V,) one number for vertices of an object that are one point."""
    triangles: Ints
    """(T, 3)."""
    caster: Bools
    """(T,)."""
    colors: list[Bounded]
    """(V,) three channels."""
    plain: Bools
    """(T,) its mesh has one colour."""
    device: Device

    @classmethod
    def of(cls, scene: Any, device: Device, offset: Sequence[Bounded]) -> Objects:
        """Everything of a scene."""
        points: list[list[Bounded]] = []
        for mesh in scene.receivers:
            vertices = np.asarray(mesh.vertices, np.float64)
            points.append([uploaded(vertices[:, k], device) for k in range(3)])
        points.append(placed(scene, offset))
        meshes = [*scene.receivers, scene.caster]
        colors = [np.asarray(mesh.color, np.float64) for mesh in meshes]
        sizes = [len(p[0].value) for p in points]
        starts = np.cumsum([0, *sizes[:-1]])
        counts = [len(np.asarray(mesh.triangles)) for mesh in meshes]
        painted = np.concatenate([np.broadcast_to(c, (n, 3)) for c, n in zip(colors, sizes, strict=True)])
        return cls(
            [_joined([p[k] for p in points]) for k in range(3)],
            np.concatenate([names_of(p) + start for p, start in zip(points, starts, strict=True)]),
            np.concatenate([np.asarray(m.triangles, np.int64) + s for m, s in zip(meshes, starts, strict=True)]),
            np.repeat([False] * len(scene.receivers) + [True], counts),
            [uploaded(painted[:, k], device) for k in range(3)],
            np.repeat([color.ndim == 1 for color in colors], counts),
            device,
        )

    def normals(self) -> list[Bounded]:
        """x, y, z (T,): unit normals; any direction where a triangle may have no area."""
        a, b, c = ([p[self.triangles[:, i]] for p in self.points] for i in range(3))
        u, v = ([x - y for x, y in zip(other, a, strict=True)] for other in (b, c))
        cross = [u[i] * v[j] - u[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]
        with np.errstate(divide="ignore", invalid="ignore"):
            found = unit(cross)
        return [
            Bounded(
                np.nan_to_num(n.value), np.where(np.isfinite(n.value + n.error), n.error, opposite(n.device)), n.device
            )
            for n in found
        ]


def _joined(parts: Sequence[Bounded]) -> Bounded:
    error = [np.broadcast_to(p.error, p.value.shape) for p in parts]
    return Bounded(np.concatenate([p.value for p in parts]), np.concatenate(error), parts[0].device)


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


def see(case: Any, device: Device) -> Seen:
    """What the camera of a case may see."""
    scene = case.scene
    width, height = int(scene.camera.width), int(scene.camera.height)
    objects = Objects.of(scene, device, places.offset(case, device))
    clip = Lens.of(scene.camera).clip_of(objects.points)
    one = exact(np.ones(len(objects.names)), device)
    painted = [one] if objects.plain.all() else [one, *objects.colors]
    cut = clipped([*clip, *objects.points, *painted], objects.triangles, objects.names, width, height)
    found = fragments(cut.x, cut.y, width, height)
    triangles, owned = Triangles.of(cut.x, cut.y, width, height, cut.setups), owners(found, cut.names, width)
    (depth,) = linear(triangles, found, [cut.z])
    depth = depth.widened(device.depth_step)
    pixel = found.rows * width + found.columns
    won = winners(pixel, owned.drawn, depth.low, depth.high, width * height, owner=owned.owner)
    shown = _only(found, won.possible)
    source = cut.source[shown.triangle]
    values = perspective(triangles, shown, cut.attributes, cut.w)
    cosine, other, edge_on = _lit(scene, objects.normals(), source, values[:3])
    seen = Seen(
        pixel=pixel[won.possible],
        triangle=source,
        caster=objects.caster[source],
        depth=depth[won.possible],
        world=values[:3],
        color=_colors(objects, source, values[3:]),
        cosine=cosine,
        other=other,
        edge_on=edge_on,
        empty=won.empty,
        wild=np.full(width * height, cut.wild),
        shape=(height, width),
        inside=np.asarray((shown.weights >= 0.0).all(axis=1)),
    )
    return _bounded(seen)


def _bounded(seen: Seen) -> Seen:
    """Without fragments of which nothing is known, such as those of triangles seen edge on: their pixels are wild."""
    numbers = [seen.depth, *seen.world, *seen.color, seen.cosine, seen.other]
    known = np.logical_and.reduce([np.isfinite(n.value + n.error) for n in numbers])
    if known.all():
        return seen
    wild = seen.wild.copy()
    wild[seen.pixel[~known]] = True
    return replace(
        seen,
        pixel=seen.pixel[known],
        triangle=seen.triangle[known],
        caster=seen.caster[known],
        depth=seen.depth[known],
        world=[axis[known] for axis in seen.world],
        color=[channel[known] for channel in seen.color],
        cosine=seen.cosine[known],
        other=seen.other[known],
        edge_on=seen.edge_on[known],
        wild=wild,
        inside=seen.inside[known],
    )


def _only(found: Fragments, kept: Bools) -> Fragments:
    return Fragments(**{field.name: getattr(found, field.name)[kept] for field in fields(found)})


@np.errstate(invalid="ignore")
def _colors(objects: Objects, source: Ints, varying: Sequence[Bounded]) -> list[Bounded]:
    """(n,) channels: of meshes with one colour as it is, which a port may interpolate all the same, else interpolated.

    varying: the number 1, of which the error is that of any constant, relative to it; and the channels, if some are painted.
    """
    one, *channels = varying
    plain = [color[objects.triangles[source, 0]] for color in objects.colors]
    plain = [p.widened(p.size * one.error) for p in plain]
    if not channels:
        return plain
    return [p.where(objects.plain[source], v) for p, v in zip(plain, channels, strict=True)]


# Where nothing is known of a fragment's place, infinite errors become NaN; such fragments are sorted out.
@np.errstate(invalid="ignore")
def _lit(
    scene: Any, normals: Sequence[Bounded], source: Ints, world: Sequence[Bounded]
) -> tuple[Bounded, Bounded, Bools]:
    """(n,) max(0, n . l) on either side of the triangle, and whether the eye may be on either."""
    device = world[0].device
    normal = [n[source] for n in normals]
    eye, light = np.asarray(scene.camera.eye, np.float64), np.asarray(scene.light.arrays[0], np.float64)
    to_eye = [uploaded(eye[k], device) - exact(eye[3], device) * world[k] for k in range(3)]
    facing = dot(normal, to_eye)
    cosine = dot(normal, unit([uploaded(light[k], device) - world[k] for k in range(3)]))
    turned = np.where(facing.value < 0.0, -1.0, 1.0)
    mine = Bounded(turned * cosine.value, cosine.error, device)
    return mine.positive(), (-mine).positive(), np.asarray(np.abs(facing.value) <= facing.error)
