"""Method "grid" of the shadow port: the four maps around an object's place as OpenGL passes, and their mix."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np

from ibr_ref.ports.glsl import gl
from ibr_ref.ports.glsl.shadow_maps import CasterMaps, Pass, Programs
from ibr_ref.ports.shadow_scene import place_in_grid


class GridMaps:
    """An application would render n x n maps beforehand; a frame needs those around the object alone."""

    def __init__(self, device: gl.Device, programs: Programs, scene: Any, params: Any) -> None:
        self._device, self._scene, self._params = device, scene, params
        self._maps = [CasterMaps(device, programs, scene, params) for _ in range(4)]
        self._mix = device.ctx.vertex_array(programs.get("screen", "mix"), [])
        self._result = Pass.of(device, int(params.map_size), int(params.map_size), "f4")

    @property
    def texture(self) -> moderngl.Texture:
        """The map that was drawn last."""
        return self._result.texture

    def draw(self, sample: Any) -> None:
        """The map for the place that a light sample sees the object at."""
        offsets, fraction = place_in_grid(self._scene, int(self._params.grid_size), sample.seen_offset)
        for each, offset in zip(self._maps, offsets, strict=True):
            each.draw(self._scene.light.camera, offset)
        self._mix.program["fraction"].value = fraction
        self._mix.program["mixed"].value = int(self._params.grid_mix)
        for unit, each in enumerate(self._maps):
            each.texture.use(unit)
        self._result.begin()
        self._device.ctx.enable_only(moderngl.NOTHING)
        self._mix.render(moderngl.TRIANGLES, vertices=3)

    def read(self) -> np.ndarray:
        """(S, S) float64 of that map."""
        return self._result.read()

    def release(self) -> None:
        """Give everything back to the driver."""
        for item in (*self._maps, self._mix, self._result):
            item.release()
