"""Splatting of depth images in WGSL: the same inputs as `ibr_ref.splatting.render`, in float32.

The scene is that of an exported case, as case_folder.py reads it; nothing else of `ibr_ref` is imported. WebGPU's points are
one pixel wide, so a splat is an instance of two triangles around its centre, snapped to 1/256 pixel in the shader; every
corner is snapped once more by the rasterizer. One draw call a reference image, one instance a valid pixel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import wgpu

from ibr_ref.ports.frame import Frame
from ibr_ref.ports.wgsl import gpu

PIXELS = gpu.Vertices(8, [("uint32x2", 0)], instanced=True)
KINDS = ["rgba32uint", "r32sint"]
ROW = 12
"""Numbers of a point: window (2), depth, width, colour (3), distance, covariance (3), weight at the centre."""


@dataclass
class _Draw:
    """The points of one reference image, ready to be submitted."""

    resources: dict[int, Any]
    pixels: np.ndarray
    """(n, 2) column and row."""


class Port:
    """The port on one device."""

    def __init__(self, device: gpu.Device | None = None) -> None:
        self.device = device or gpu.create_device()

    def render(self, scene: Any, params: Any) -> Frame:
        """One frame with all stages, read back. Raises ValueError for what is not ported."""
        if params.shape not in ("square", "disc", "ellipse"):
            raise ValueError(f"shape = {params.shape!r}: the port allows square, disc, ellipse")
        light = scene.light
        constants = {
            "LIT": light is not None,
            "EXPONENT": 0 if light is None else int(light.exponent),
            "DISC": params.shape == "disc",
            "ELLIPSE": params.shape == "ellipse",
        }
        code = gpu.constants(constants) + gpu.source("lighting.wgsl", "splatting.wgsl")
        draws: list[_Draw] = []
        for image in scene.images:
            draws.append(self._image(scene, params, image, first=sum(len(draw.pixels) for draw in draws)))
        width, height = int(scene.camera.width), int(scene.camera.height)
        color, splat, depth = (gpu.target(self.device, width, height, kind) for kind in (*KINDS, "depth32float"))
        self._draw(draws, code, [(color, gpu.bits([*scene.background, 0.0])), (splat, (-1, 0, 0, 0))], depth)
        depths = gpu.read_depth(self.device, depth).astype(np.float64)
        shown = {"raster.splat": gpu.read_texture(self.device, splat), "raster.depth": depths.copy()}
        rows, sources = self._rows(draws, code)
        stages = _vertices(rows, sources, params.shape == "ellipse") | shown
        if params.shape == "ellipse":
            color, sums = self._averaged(scene, draws, code, rows, color)
            stages |= {"raster.weight": sums.view(np.float32)[..., 0], "raster.blended": sums[..., 1].astype(np.int32)}
        picture = gpu.read_floats(self.device, color)[..., :3].astype(np.float64)
        return Frame(picture, depths, stages)

    def _averaged(
        self, scene: Any, draws: list[_Draw], code: str, rows: np.ndarray, nearest: Any
    ) -> tuple[Any, np.ndarray]:
        """The picture of ellipses, and (H, W, 4) bits of the weights' sums, and counts."""
        width, height = int(scene.camera.width), int(scene.camera.height)
        color, sums = (gpu.target(self.device, width, height, "rgba32uint") for _ in range(2))
        code, kinds = code + gpu.SCREEN, ["rgba32uint", "rgba32uint"]
        pipeline = gpu.pipeline(self.device, code, ("screen", "averaged"), kinds, depth=False)
        splats = gpu.buffer(self.device, rows.tobytes(), wgpu.BufferUsage.STORAGE)
        resources = {0: draws[0].resources[0], 6: splats, 7: nearest}
        cleared = [(color, gpu.bits([*scene.background, 0.0])), (sums, (0, 0, 0, 0))]
        gpu.screen(self.device, pipeline, resources, cleared)
        return color, gpu.read_texture(self.device, sums)

    def _image(self, scene: Any, params: Any, image: Any, first: int) -> _Draw:
        """Uniforms and textures of one reference image."""
        normals = getattr(image, "normals", None)
        normals = np.zeros((1, 1, 3)) if normals is None else normals
        block = gpu.buffer(self.device, _uniforms(scene, params, image, first), wgpu.BufferUsage.UNIFORM)
        textures = [gpu.upload(self.device, each) for each in (image.depth, image.color, normals)]
        pixels = np.argwhere(np.asarray(image.mask))[:, ::-1].astype(np.uint32)
        return _Draw({0: block, **dict(enumerate(textures, 1))}, np.ascontiguousarray(pixels))

    def _draw(self, draws: list[_Draw], code: str, colors: list[tuple[Any, Any]], depth: Any) -> None:
        pipeline = gpu.pipeline(self.device, code, ("vertex", "fragment"), KINDS, [PIXELS])
        encoder = self.device.device.create_command_encoder()
        drawing = gpu.begin(encoder, colors, depth)
        drawing.set_pipeline(pipeline)
        for draw in draws:
            if len(draw.pixels):
                drawing.set_bind_group(0, gpu.bind(self.device, pipeline, draw.resources))
                drawing.set_vertex_buffer(0, gpu.buffer(self.device, draw.pixels.tobytes(), wgpu.BufferUsage.VERTEX))
                drawing.draw(6, len(draw.pixels))
        drawing.end()
        self.device.device.queue.submit([encoder.finish()])

    def _rows(self, draws: list[_Draw], code: str) -> tuple[np.ndarray, np.ndarray]:
        """(V, ROW) the points, as the shader makes them, and (V, 3) their sources."""
        rows, sources = [np.zeros((0, ROW), np.float32)], [np.zeros((0, 3), np.int32)]
        storage, copied = wgpu.BufferUsage.STORAGE, wgpu.BufferUsage.COPY_SRC
        for number, draw in enumerate(draws):
            count = len(draw.pixels)
            if not count:
                continue
            given = gpu.buffer(self.device, draw.pixels.tobytes(), storage)
            made = gpu.buffer(self.device, bytes(4 * ROW * count), storage | copied)
            gpu.compute(self.device, code, "vertices", {**draw.resources, 4: given, 5: made}, count)
            rows.append(gpu.read_buffer(self.device, made, np.float32, ROW)[:count])
            sources.append(np.pad(draw.pixels[:, ::-1].astype(np.int32), ((0, 0), (1, 0)), constant_values=number))
        return np.concatenate(rows), np.concatenate(sources)


def _vertices(rows: np.ndarray, sources: np.ndarray, elliptic: bool) -> dict[str, np.ndarray]:
    """The stages "vertex.*"."""
    dropped = rows[:, 3] < 0.0
    left = np.where(dropped[:, None], np.float32(np.nan), rows)
    found = {
        "vertex.window": left[:, :2],
        "vertex.depth": left[:, 2],
        "vertex.width": np.where(dropped, 0.0, rows[:, 3]),
        "vertex.color": rows[:, 4:7],
        "vertex.source": sources,
    }
    if not elliptic:
        return found
    shapes = {"vertex.covariance": left[:, 8:11], "vertex.amplitude": left[:, 11], "vertex.distance": left[:, 7]}
    return found | shapes


def _uniforms(scene: Any, params: Any, image: Any, first: int) -> bytes:
    """The block `Splats`, computed in float64, rounded once."""
    camera, light, reference = scene.camera, scene.light, image.camera
    (f_x, skew, c_x), (_, f_y, c_y), _ = np.asarray(reference.intrinsics, float).tolist()
    matrices = [reference.world_from_view, camera.view_from_world, camera.clip_from_view]
    vectors = [(c_x, c_y, 1.0 / f_x, 1.0 / f_y), (skew, reference.perspective, camera.perspective), camera.eye]
    vectors += [(), ()] if light is None else [light.homogeneous, (light.ambient, light.diffuse, light.specular)]
    vectors += [(params.alpha, params.beta, params.gamma, params.delta), (params.min_width, params.max_width)]
    vectors += [(camera.width, camera.height)]
    vectors += [(params.footprint, params.low_pass, params.cutoff, params.depth_tolerance)]
    columns = [np.asarray(matrix, np.float32).T.ravel() for matrix in matrices]
    padded = [np.pad(np.asarray(vector, np.float32), (0, 4 - len(vector))) for vector in vectors]
    return np.concatenate(columns + padded).tobytes() + np.array([first, 0, 0, 0], np.int32).tobytes()
