"""Ellipses for squares: elliptical Gaussians in the vertex stage, and their weighted averages for the nearest's colours."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Image, Ints, Vector
from ibr_ref.oracle.programs.splatting.raster import Fragments, Raster, Splats
from ibr_ref.oracle.programs.splatting.vertex import Clip, Texels, Vertex

LEAST_COSINE = 0.5
"""Of the angle between normal and line of sight (splatting/method.md, "Ellipses")."""
LEAST_AMPLITUDE = 2.0**-20
"""Of splats that are seen from their edge."""


class Sums(NamedTuple):
    """What the second pass adds up of each pixel, all pixels in one row (P,)."""

    weight: Floats
    blended: Ints
    """How many were added."""
    color: Floats
    """(P, 3) their average."""


class Footprints(Vertex):
    """Stage vertex: the Gaussian of a reference pixel in the window."""

    def sized(self, image: Image, texels: Texels, world: Vector, view: Vector, clip: Clip) -> tuple[Floats, Vector]:
        """The larger side of the ellipse's box, and xx, xy, yy, amplitude and distance."""
        if not self.elliptic:
            return super().sized(image, texels, world, view, clip)
        tell = self.do.told
        x_u, y_u, x_v, y_v = tell("Jacobian x_u, y_u, x_v, y_v", self.jacobian(image, texels, view, clip))
        *covariance, amplitude = self.gaussian(x_u, y_u, x_v, y_v)
        tell("covariance xx, xy, yy", covariance)
        tell("amplitude", amplitude)
        distance = tell("distance along the axis", self.axis_distance(image, world, view))
        return self.larger_side(covariance), [*covariance, amplitude, distance]

    def axis_distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        """-z of view space. The image is the one that the points are of."""
        return np.negative(view[2])

    # --- Jacobian ----------------------------------------------------------------------------------------------------

    def jacobian(self, image: Image, texels: Texels, view: Vector, clip: Clip) -> Vector:
        """x_u, y_u, x_v, y_v: window pixels as a point moves on its tangent plane by a reference pixel."""
        normal = self.do.told("normal of the footprint", self.tangent_normal(texels.codes))
        steps = self.surface_steps(image.camera, texels, normal)
        ndc = [self.do.divide(value, clip[3]) for value in clip[:2]]
        return [x for step in steps for x in self.window_step(step, ndc, clip[3])]

    def tangent_normal(self, codes: Vector) -> Vector:
        """Of the tangent plane: the 8-bit normal."""
        return self.normal(codes)

    def surface_steps(self, camera: Any, texels: Texels, normal: Vector) -> list[Vector]:
        """P_u and P_v, world space: to the next pixel on the right, and below, on the tangent plane."""
        x_n, y_n = self.image_plane(camera, self.center(texels.columns), self.center(texels.rows))
        one = np.ones(np.shape(x_n))
        steps = [self.turned(camera, step) for step in self.pixel_steps(camera, texels.depth)]
        sight = self.turned(camera, self.sight(camera, x_n, y_n, one))
        facing = self.do.told("n.d, bounded", self.facing(normal, sight))
        return [self.along_plane(step, sight, normal, facing) for step in steps]

    def pixel_steps(self, camera: Any, depth: Floats) -> list[Vector]:
        """In the reference camera's view space, at a constant depth."""
        (f_x, s, _), (_, f_y, _), _ = self.do.matrix(self.intrinsics(camera))
        scale = self.step_scale(camera, depth)
        across, down = self.do.divide(scale, f_x), self.do.divide(scale, f_y)
        aside = np.negative(self.do.multiply(across, self.do.divide(s, f_y)))
        return [[across, 0.0, 0.0], [aside, np.negative(down), 0.0]]

    def step_scale(self, camera: Any, depth: Floats) -> Floats:
        """What a pixel's step grows with: the depth; orthographic, nothing."""
        return depth if camera.perspective else np.ones(np.shape(depth))

    def sight(self, camera: Any, x_n: Floats, y_n: Floats, one: Floats) -> Vector:
        """The line of sight through a pixel, at depth 1; orthographic, the axis."""
        if camera.perspective:
            return [x_n, np.negative(y_n), -one]
        return [0.0 * one, 0.0 * one, -one]

    def turned(self, camera: Any, step: Vector) -> Vector:
        """A direction under the linear part of T_R→W."""
        return self.linear(self.world_from_view(camera)[:3, :3], step)

    def linear(self, matrix: Any, step: Vector) -> Vector:
        """A direction under a matrix (rows, 3)."""
        return [self.do.dot(list(row), step) for row in self.do.matrix(matrix)]

    def facing(self, normal: Vector, sight: Vector) -> Floats:
        """n·d, at most -LEAST_COSINE |d|: a plane that is seen from its edge is turned."""
        most = self.do.multiply(-self.least_cosine(), self.do.root(self.do.dot(sight, sight)))
        return np.minimum(self.do.dot(normal, sight), most)

    def least_cosine(self) -> float:
        """Of the angle between normal and line of sight."""
        return LEAST_COSINE

    def along_plane(self, step: Vector, sight: Vector, normal: Vector, facing: Floats) -> Vector:
        """A step in the image, taken on the tangent plane: e - d (n·e)/(n·d)."""
        way = self.do.divide(self.do.dot(normal, step), facing)
        return [self.do.subtract(e, self.do.multiply(d, way)) for e, d in zip(step, sight, strict=True)]

    def window_step(self, step: Vector, ndc: Vector, w: Floats) -> Vector:
        """Window pixels along a world-space step: the derivative of (x/w, y/w), x and y of clip space."""
        view = self.linear(np.asarray(self.scene.camera.view_from_world)[:3, :3], step)
        rows = np.asarray(self.scene.camera.clip_from_view)[[0, 1, 3], :3]
        x, y, along = self.linear(rows, view)
        width, height = self.scene.camera.width, self.scene.camera.height
        return [
            self.do.multiply(self.do.divide(self.projected_step(x, ndc[0], along), w), 0.5 * width),
            self.do.multiply(self.do.divide(self.projected_step(y, ndc[1], along), w), -0.5 * height),
        ]

    def projected_step(self, x: Floats, ndc: Floats, along: Floats) -> Floats:
        """d(x/w) w: x' - (x/w) w'."""
        return self.do.subtract(x, self.do.multiply(ndc, along))

    # --- Gaussian ----------------------------------------------------------------------------------------------------

    def variances(self) -> tuple[Floats, Floats]:
        """Of the footprint, square reference pixels, and of the filter, square pixels of the picture."""
        footprint, low_pass = (self.do.number(getattr(self.params, name)) for name in ("footprint", "low_pass"))
        return self.do.multiply(footprint, footprint), self.do.multiply(low_pass, low_pass)

    def gaussian(self, x_u: Floats, y_u: Floats, x_v: Floats, y_v: Floats) -> Vector:
        """xx, xy, yy of footprint² J Jᵀ + low_pass² I, and the weight at the centre."""
        footprint, _ = self.variances()
        squares = self.squares(x_u, y_u, x_v, y_v)
        determinant = self.do.dot([x_u, -x_v], [y_v, y_u])
        amplitude = self.amplitude(self.do.multiply(footprint, np.abs(determinant)), squares)
        scaled = [self.do.multiply(footprint, x) for x in squares]
        shrink = self.shrink(scaled)
        return [*self.filtered([self.do.multiply(x, shrink) for x in scaled]), amplitude]

    def squares(self, x_u: Floats, y_u: Floats, x_v: Floats, y_v: Floats) -> Vector:
        """xx, xy, yy of J Jᵀ."""
        dot = self.do.dot
        return [dot([x_u, x_v], [x_u, x_v]), dot([x_u, x_v], [y_u, y_v]), dot([y_u, y_v], [y_u, y_v])]

    def filtered(self, covariance: Vector) -> Vector:
        """With the filter of the picture's pixels."""
        xx, xy, yy = covariance
        _, low_pass = self.variances()
        return [self.do.add(xx, low_pass), xy, self.do.add(yy, low_pass)]

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        """s |det J| / sqrt(det C) = a / sqrt(a² + s h |J|² + h²), a = s |det J|: footprint and filter convolved."""
        footprint, low_pass = self.variances()
        rest = [self.do.multiply(self.do.multiply(footprint, low_pass), self.do.add(squares[0], squares[2]))]
        whole = self.do.sum([self.do.multiply(area, area), *rest, self.do.multiply(low_pass, low_pass)])
        found = self.do.divide(area, self.do.root(whole))
        return np.minimum(np.maximum(found, LEAST_AMPLITUDE), 1.0)

    def shrink(self, covariance: Vector) -> Floats:
        """What variances are multiplied by, so that with the filter's no side of the box is above max_width."""
        _, low_pass = self.variances()
        cutoff, most = (self.do.number(getattr(self.params, name)) for name in ("cutoff", "max_width"))
        side = self.do.divide(most, self.do.multiply(2.0, cutoff))
        room = self.do.subtract(self.do.multiply(side, side), low_pass)
        return np.minimum(self.do.divide(room, np.maximum(covariance[0], covariance[2])), 1.0)

    def larger_side(self, covariance: Vector) -> Floats:
        """2 cutoff √max(xx, yy), pixels."""
        most = np.maximum(covariance[0], covariance[2])
        return self.do.multiply(self.do.multiply(2.0, self.do.number(self.params.cutoff)), self.do.root(most))


class Ellipses(Raster):
    """Stage raster: coverage by ellipses, and the sums over those of one surface."""

    def inside(self, splats: Splats, fragments: Fragments) -> Bools:
        """dᵀ C⁻¹ d ≤ cutoff²."""
        if not self.elliptic:
            return super().inside(splats, fragments)
        return self.covers(self.squared_distance(splats, fragments))

    def spans(self, splats: Splats) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """Of the ellipse's box."""
        if not self.elliptic:
            return super().spans(splats)
        camera, (xx, _, yy, *_) = self.scene.camera, splats.gaussian.T
        half = [self.do.multiply(self.do.number(self.params.cutoff), self.do.root(x)) for x in (xx, yy)]
        return self.span(splats.x, half[0], camera.width), self.span_of_rows(splats.y, half[1], camera.height)

    def squared_distance(self, splats: Splats, fragments: Fragments) -> Floats:
        """q of pixels' centres, in squared standard deviations."""
        splat, border = fragments.splat, self.do.border
        dx = self.do.named("dx", self.do.subtract(fragments.column + 0.5, border(splats.x[splat])))
        dy = self.do.named("dy", self.do.subtract(fragments.row + 0.5, border(splats.y[splat])))
        xx, xy, yy, *_ = splats.gaussian[splat].T
        return self.quadratic(dx, dy, xx, xy, yy)

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        """(yy dx² - 2 xy dx dy + xx dy²)/det, or with the inverse of C made first."""
        do, determinant = self.do, self.determinant(xx, xy, yy)
        squares = [do.multiply(dx, dx), do.multiply(do.multiply(dx, dy), -2.0), do.multiply(dy, dy)]
        whole = do.divide(do.dot([yy, xy, xx], squares), determinant)
        return do.either(whole, lambda: do.dot([do.divide(x, determinant) for x in (yy, xy, xx)], squares))

    def determinant(self, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        """xx yy - xy²."""
        return self.do.dot([xx, -xy], [yy, xy])

    def covers(self, q: Floats) -> Bools:
        """Whether a centre lies within the cutoff."""
        cutoff = self.do.number(self.params.cutoff)
        return q <= self.do.multiply(cutoff, cutoff)

    # --- Second pass -------------------------------------------------------------------------------------------------

    def second_pass(self, vertices: dict[str, Any], winner: Ints) -> Sums:
        """Weights, counts and colours of all pixels, of the nearest splats (H, W) of the first pass."""
        splats, nearest = self.live(vertices), winner.reshape(-1)
        distance, images = vertices["vertex.distance"], vertices["vertex.source"][:, 0]
        found = [(np.zeros(0, np.int64), np.zeros(0), np.zeros((0, 3)))]
        for _, batch in self.batches(splats):
            fragments = self.fragments(batch)
            pixel = fragments.row * self.scene.camera.width + fragments.column
            at, vertex = nearest[pixel], batch.vertex[fragments.splat]
            near = self.blends(distance[vertex], distance[np.maximum(at, 0)]) | (self.names(images, vertex) == at)
            near &= at >= 0
            kept = Fragments._make(values[near] for values in fragments)
            weight = self.weight(batch, kept)
            found.append((pixel[near], weight, vertices["vertex.color"][batch.vertex[kept.splat]]))
        pixels, weights, colors = (np.concatenate(parts) for parts in zip(*found, strict=True))
        order = np.argsort(pixels, kind="stable")
        of, weight, color, count = pixels[order], weights[order], colors[order], len(nearest)
        sums = self.summed(weight, of, count)
        average = np.stack([self.averaged(weight, channel, of, count) for channel in color.T], axis=1)
        return Sums(sums, np.bincount(of, minlength=count).astype(np.int32), average)

    def weight(self, splats: Splats, fragments: Fragments) -> Floats:
        """amplitude · exp(-q/2)."""
        amplitude = splats.gaussian[fragments.splat].T[3]
        return self.contribution(amplitude, self.squared_distance(splats, fragments))

    def contribution(self, amplitude: Floats, q: Floats) -> Floats:
        """Of a splat, at a squared radius."""
        return self.do.multiply(amplitude, self.falloff(q))

    def falloff(self, q: Floats) -> Floats:
        """exp(-q/2)."""
        return self.do.exponential(self.do.multiply(q, -0.5))

    def blends(self, distance: Floats, nearest: Floats) -> Bools:
        """Whether splats are of the surface of the nearest one."""
        return distance <= self.do.multiply(self.reach(), nearest)

    def reach(self) -> Floats:
        """1 + depth_tolerance."""
        return self.do.add(1.0, self.do.number(self.params.depth_tolerance))

    def summed(self, weight: Floats, of: Ints, count: int) -> Floats:
        """(count,) sums of the weights (n,) that each row has; of (n,) growing."""
        return self.do.totals(weight, of, count)

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        """(count,) weighted averages of what each row has, at most 1: weight, channel and of (n,), `of` growing."""
        return np.minimum(self.do.mean(weight, channel, of, count), 1.0)
