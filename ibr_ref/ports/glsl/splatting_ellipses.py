"""The passes of splatting by ellipses on OpenGL: the nearest splats, sums over their surfaces, averages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import moderngl
import numpy as np

from ibr_ref.ports.glsl import gl

NEAREST = {"splat": (1, "i4"), "distance": (1, "f4"), "deep": (1, "f4")}
SUMS = {"sums": (4, "f4"), "count": (1, "f4")}


class Averages:
    """Targets of the three passes, and what draws each; each of `draws` has a program for either of the first two."""

    def __init__(
        self, device: gl.Device, scene: Any, color: gl.Target, first: Sequence[Any], second: Sequence[Any]
    ) -> None:
        """color: what the averages are drawn into."""
        width, height = int(scene.camera.width), int(scene.camera.height)
        self.device, self.color, self.first, self.second = device, color, first, second
        self.nearest = gl.create_target(device, width, height, NEAREST)
        self.nearest.clears = {"splat": (-1,), "deep": (1.0,)}
        self.sums = gl.create_target(device, width, height, SUMS)
        source = "#version 450 core\n"
        self.program = device.ctx.program(
            vertex_shader=source + gl.source("shadows_screen.vert"),
            fragment_shader=source + gl.source("splatting_average.frag"),
        )
        background: Any = self.program["background"]
        background.value = (*map(float, scene.background), 0.0)
        self.screen = device.ctx.vertex_array(self.program, [])

    def draw(self) -> None:
        """A frame."""
        ctx = self.device.ctx
        self.nearest.begin()
        ctx.enable_only(moderngl.DEPTH_TEST)
        ctx.depth_func = "<"
        for draw in self.first:
            draw.bind()
            draw.vao.render(moderngl.TRIANGLES)
        self.sums.begin()
        ctx.enable_only(moderngl.BLEND)
        ctx.blend_func = moderngl.ONE, moderngl.ONE
        for draw in self.second:
            draw.bind()
            self.nearest.textures["distance"].use(2)
            draw.vao.render(moderngl.TRIANGLES)
        self.color.begin()
        ctx.enable_only(moderngl.NOTHING)
        self.sums.textures["sums"].use(0)
        self.screen.render(moderngl.TRIANGLES, vertices=3)

    def read_depth(self) -> np.ndarray:
        """(H, W) of the first pass."""
        return self.nearest.read_depth().astype(np.float64)

    def stages(self) -> dict[str, np.ndarray]:
        """The stages "raster.*"."""
        return {
            "raster.splat": self.nearest.read("splat")[..., 0],
            "raster.depth": self.read_depth(),
            "raster.weight": self.sums.read("sums")[..., 3],
            "raster.blended": self.sums.read("count")[..., 0].astype(np.int32),
        }

    def release(self) -> None:
        """Give everything back to the driver."""
        for target in (self.nearest, self.sums):
            target.release()
        for item in (self.screen, self.program):
            item.release()
