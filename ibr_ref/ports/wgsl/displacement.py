"""Protruded displacement mapping in WGSL: the same inputs as `ibr_ref.displacement.render`, in float32.

The scene is that of an exported case, as case_folder.py reads it; nothing else of `ibr_ref` is imported. Ported is
method="protruded" with all intervals, domains, faces and depths, normal map, facade map and self-shadow, and the searches
below the polygon that there are cases of. Each of three
passes draws all polygons with a depth buffer of its own and hands on two attachments; the depth tests come out alike, as
the passes compute the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import wgpu

from ibr_ref.ports.displacement_arrays import below_one_another, stage_arrays
from ibr_ref.ports.frame import Frame
from ibr_ref.ports.glsl.patch_frame import PatchFrame
from ibr_ref.ports.wgsl import gpu

PASSES = {
    "picture": (("color", "rgba32uint"), ("index", "rgba32sint")),
    "hits": (("patch", "rgba32uint"), ("hit", "rgba32uint")),
    "looks": (("albedo", "rgba32uint"), ("normal", "rgba32uint")),
}
"""By entry point: attachments and their kinds."""
SEARCHES = (
    "protruded",
    "relief",
    "mcguire",
    "tatarchuk",
    "welsh",
    "cone",
    "relaxed_cone",
    "donnelly",
    "maximum_mipmap",
)
"""By their numbers in the shader."""
CORNERS = gpu.Vertices(16, [("float32x3", 0), ("sint32", 12)])


@dataclass
class _Draw:
    """One polygon, ready to be submitted."""

    code: str
    resources: dict[int, Any]
    faces: np.ndarray
    vertices: Any
    indices: Any


class Port:
    """The port on one device."""

    def __init__(self, device: gpu.Device | None = None) -> None:
        self.device = device or gpu.create_device()

    def render(self, scene: Any, params: Any) -> Frame:
        """One frame with all stages, read back. Raises ValueError for what is not ported."""
        if params.method not in SEARCHES:
            raise ValueError(f"method = {params.method!r}: the port allows {', '.join(SEARCHES)}")
        frames = [PatchFrame.of(polygon, scene) for polygon in scene.polygons]
        draws = [draw for number, frame in enumerate(frames) if (draw := self._draw(frame, number, params)) is not None]
        width, height = int(scene.camera.width), int(scene.camera.height)
        depth = gpu.target(self.device, width, height, "depth32float")
        found: dict[str, np.ndarray] = {}
        for entry, attachments in PASSES.items():
            targets = [gpu.target(self.device, width, height, kind) for _, kind in attachments]
            background = gpu.bits([*scene.background, 0.0])
            clears = [background, (-1, -1, -1, -1)] if entry == "picture" else [(0, 0, 0, 0)] * 2
            self._pass(draws, entry, list(zip(targets, clears, strict=True)), depth)
            pairs = zip(attachments, targets, strict=True)
            for (name, kind), each in pairs:
                read = gpu.read_floats if kind == "rgba32uint" else gpu.read_texture
                found[name] = read(self.device, each)
            if entry == "picture":
                found["depth"] = gpu.read_depth(self.device, depth).astype(np.float64)
        stages = stage_arrays(*(found[name] for name in ("index", "patch", "hit", "albedo", "normal")))
        depths = np.where(stages["march.hit_index"] < 0, 1.0, found["depth"])
        return Frame(found["color"][..., :3].astype(np.float64), depths, self._vertices(draws) | stages)

    def _draw(self, frame: PatchFrame, number: int, params: Any) -> _Draw | None:
        """Buffers, textures and code of one polygon; None: no face of it is drawn."""
        faces = frame.faces(params.faces if params.method == "protruded" else "base", params.interval)
        if not len(faces):
            return None
        device, polygon, unused = self.device, frame.polygon, np.zeros((1, 1, 3))
        maps = [polygon.height_map, polygon.color_map, polygon.normal_map, polygon.facade_map]
        resources: dict[int, Any] = {0: gpu.buffer(device, frame.uniforms(number), wgpu.BufferUsage.UNIFORM)}
        resources |= {i: gpu.upload(device, unused if m is None else m) for i, m in enumerate(maps, 1)}
        resources[7] = gpu.upload(device, _search_map(polygon, unused))
        quads = 4 * np.arange(len(faces))[:, None] + np.array([0, 1, 2, 0, 2, 3])
        return _Draw(
            code=_constants(frame, params)
            + gpu.source("lighting.wgsl", "displacement.wgsl", "displacement_below.wgsl"),
            resources=resources,
            faces=faces,
            vertices=gpu.buffer(device, faces.tobytes(), wgpu.BufferUsage.VERTEX),
            indices=gpu.buffer(device, quads.astype(np.uint32).tobytes(), wgpu.BufferUsage.INDEX),
        )

    def _pass(self, draws: list[_Draw], entry: str, colors: list[tuple[Any, Any]], depth: Any) -> None:
        encoder = self.device.device.create_command_encoder()
        drawing = gpu.begin(encoder, colors, depth)
        kinds = [kind for _, kind in PASSES[entry]]
        for draw in draws:
            pipeline = gpu.pipeline(self.device, draw.code, ("vertex", entry), kinds, [CORNERS])
            drawing.set_pipeline(pipeline)
            drawing.set_bind_group(0, gpu.bind(self.device, pipeline, draw.resources))
            drawing.set_vertex_buffer(0, draw.vertices)
            drawing.set_index_buffer(draw.indices, "uint32")
            drawing.draw_indexed(6 * len(draw.faces))
        drawing.end()
        self.device.device.queue.submit([encoder.finish()])

    def _vertices(self, draws: list[_Draw]) -> dict[str, np.ndarray]:
        """The corners in patch space, and in clip space as the shader makes them."""
        clips, points = [np.zeros((0, 4), np.float32)], [np.zeros((0, 3), np.float32)]
        storage, copied = wgpu.BufferUsage.STORAGE, wgpu.BufferUsage.COPY_SRC
        for draw in draws:
            patch = draw.faces["patch"].reshape(-1, 3)
            rows = np.column_stack([patch, np.zeros(len(patch), np.float32)])
            given = gpu.buffer(self.device, rows.tobytes(), storage)
            made = gpu.buffer(self.device, np.zeros_like(rows).tobytes(), storage | copied)
            gpu.compute(self.device, draw.code, "vertices", {0: draw.resources[0], 5: given, 6: made}, len(rows))
            clips.append(gpu.read_buffer(self.device, made, np.float32, 4))
            points.append(patch)
        return {"vertex.clip": np.concatenate(clips), "vertex.patch": np.concatenate(points)}


def _search_map(polygon: Any, unused: np.ndarray) -> np.ndarray:
    """What the search has besides heights: ratios of cones, layers of distances or levels of a quadtree, in one picture."""
    cones, distances, levels = (getattr(polygon, name, None) for name in ("cone_map", "distance_map", "quadtree"))
    if levels is not None:
        return below_one_another(levels)
    if distances is not None:
        return np.vstack(distances)
    return unused if cones is None else cones


def _constants(frame: PatchFrame, params: Any) -> str:
    """`params` and the shape of the scene."""
    polygon, above = frame.polygon, params.method == "protruded"
    return gpu.constants(
        {
            "LINEAR_STEPS": int(params.linear_steps),
            "BINARY_STEPS": int(params.binary_steps),
            "SHADOW_STEPS": int(params.shadow_steps),
            "SHADOW_BIAS": float(params.shadow_bias),
            "STEEP_THRESHOLD": float(params.steep_threshold),
            "EXPONENT": int(frame.scene.light.exponent),
            "HAS_NORMAL_MAP": polygon.normal_map is not None,
            "HAS_FACADE_MAP": polygon.facade_map is not None and above,
            "POLYGON_DEPTH": params.depth == "polygon" or params.method == "welsh",
            "FLOOR": 0.0 if above or params.method == "welsh" else -1.0,
            "DISTANCE_LAYERS": int(params.distance_layers),
            "MIN_STEPS": int(params.min_steps),
            "MAX_STEPS": int(params.max_steps),
            "SEARCH": SEARCHES.index(params.method),
            **{name.upper(): number for number, name in enumerate(SEARCHES)},
            "REPEAT": polygon.domain == "repeat",
            "VOLUME": params.interval == "volume",
        }
    )
