"""What the case hands over, and where the samples of the light are."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy
from ibr_ref.oracle.ports.shadows.raster import Raster
from ibr_ref.oracle.ports.shadows.sampler import Sampler


class Lights:
    """The foundation of the port: scene, parameters, arithmetic, and the light's samples."""

    arithmetic: type[Arithmetic] = Arithmetic
    """How the device calculates."""
    map_raster: type[Raster] = Raster
    """Draws the nine maps."""
    direct_raster: type[Raster] = Raster
    """Draws the maps of method "direct"."""
    warp_raster: type[Raster] = Raster
    """Draws the meshes of control points."""
    surface_raster: type[Raster] = Raster
    """Draws the picture."""
    warp_sampler: type[Sampler] = Sampler
    """Fetches from the images that are warped."""
    shadow_sampler: type[Sampler] = Sampler
    """Fetches from the map that is projected."""

    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        self.scene, self.params, self.inputs = scene, params, inputs
        self.ops = self.arithmetic(policy)
        number = self.ops.number
        self.centre, self.half_edges = number(scene.light.position), number(scene.light.half_edges)
        self.axes, self.offset = number(scene.offset_axes), number(scene.offset)
        camera = scene.light.camera(params.map_size)
        self.light_rotation, self.clip_from_light = (
            number(camera.view_from_world[:3, :3]),
            number(camera.clip_from_view),
        )
        self.places = self.sample_places()

    def steps(self) -> list[tuple[float, float]]:
        """(g_i, g_j) of the samples of 5 or 9: j outer, i inner, the centre first."""
        g = {5: (-2.0 / 3.0, 2.0 / 3.0), 9: (-2.0 / 3.0, 0.0, 2.0 / 3.0)}[self.params.light_samples]
        return [(0.0, 0.0), *((x, y) for y in g for x in g if (x, y) != (0.0, 0.0))]

    def sample_places(self) -> list[Floats]:
        """(3,) world positions of the samples in use."""
        if isinstance(self.params.light_samples, np.ndarray):
            return list(self.ops.number(self.params.light_samples))
        if self.params.light_samples == 1:
            return [self.centre]
        a, b = self.half_edges
        steps = [self.ops.number(step) for step in self.steps()]
        return [self.ops.add(self.centre, self.ops.dot([a, b], list(step))) for step in steps]

    def displacement(self, place: Floats) -> Floats:
        """(2,) on the two axes: of a sample from the light's centre."""
        return self.on_axes(self.ops.subtract(place, self.centre))

    def on_axes(self, vector: Floats) -> Floats:
        """(2,) the x and y of the point x a + y b next to a vector (3,), by the axes' Gram matrix."""
        ops, (a, b) = self.ops, [list(axis) for axis in self.axes]
        aa, ab, bb = ops.dot(a, a), ops.dot(a, b), ops.dot(b, b)
        va, vb = ops.dot(list(vector), a), ops.dot(list(vector), b)
        determinant = self._difference(aa, bb, ab, ab)
        x, y = self._difference(bb, va, ab, vb), self._difference(aa, vb, ab, va)
        return np.stack([ops.divide(x, determinant), ops.divide(y, determinant)])

    def _difference(self, a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
        return self.ops.subtract(self.ops.multiply(a, b), self.ops.multiply(c, d))

    def light_view(self, place: Floats) -> Floats:
        """(4, 4) view_from_world of the light at a place: it looks where it looks from its centre."""
        view = np.eye(4)
        view[:3, :3] = self.light_rotation
        view[:3, 3] = [-self.ops.dot(list(axis), list(place)) for axis in self.light_rotation]
        return view
