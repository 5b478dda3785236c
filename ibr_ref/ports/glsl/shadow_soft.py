"""Method "pcss" of the shadow port: the one map that is softened, and where it is asked."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np

from ibr_ref.ports.glsl import gl
from ibr_ref.ports.glsl.shadow_maps import CasterMaps, Programs


class SoftMap:
    """Window depths of the caster, parallel to the light, and the light's points."""

    def __init__(self, device: gl.Device, programs: Programs, scene: Any, params: Any) -> None:
        self._scene, self._map = scene, CasterMaps(device, programs, scene, params)
        points = scene.soft.search, scene.soft.filter
        self._points = [gl.upload(device, np.asarray(each)[None], filtered=False) for each in points]

    @property
    def texture(self) -> moderngl.Texture:
        """The map."""
        return self._map.texture

    def draw(self, sample: Any) -> None:
        """The map is the same for whatever sample."""
        self._map.draw(self._scene.soft, self._scene.offset)

    def ask(self, program: moderngl.Program) -> None:
        """What the projection needs besides matrices and map."""
        soft = self._scene.soft
        program["planes"].value = float(soft.near), float(soft.far), float(soft.nearest)
        for unit, texture in enumerate(self._points, 2):
            texture.use(unit)

    def read(self) -> np.ndarray:
        """(S, S) float64."""
        return self._map.read()

    def release(self) -> None:
        """Give everything back to the driver."""
        for item in (self._map, *self._points):
            item.release()
