"""Shadows by image warping in WGSL: the same inputs as `ibr_ref.shadows.render`, in float32.

Scene, parameters and prepared maps are those of an exported case, as case_folder.py reads it; nothing else of `ibr_ref` is
imported. Ported are all methods, masks and depths, both policies, every way to compare, and both ways to accumulate. The
passes of a frame: receivers and caster into place and surface; per light sample its map, warped by three draw calls,
rendered, or mixed from four, and its projection (of method="pcss" that of shadows_soft.wgsl); the sum, added in a shader for
floats, blended for bytes; the colour.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import wgpu

from ibr_ref.ports.frame import Frame
from ibr_ref.ports.shadow_scene import (
    mesh_indices,
    offset_in_world,
    place_in_cell,
    place_in_grid,
    shares_in_cell,
    vertices,
)
from ibr_ref.ports.wgsl import gpu

FLOAT, FLOATS = "r32uint", "rgba32uint"
"""One or four floats a texel, as their bits."""
SEEN = gpu.Vertices(40, [("float32x3", 0), ("float32x3", 12), ("float32x3", 24), ("float32", 36)])
CASTER = gpu.Vertices(12, [("float32x3", 0)])
POINTS = gpu.Vertices(32, [("float32x2", 8 * k) for k in range(4)])
ADD = {
    "color": {"src_factor": "src-alpha", "dst_factor": "one", "operation": "add"},
    "alpha": {"src_factor": "one", "dst_factor": "one", "operation": "add"},
}


class Port:
    """The port on one device."""

    def __init__(self, device: gpu.Device | None = None) -> None:
        self.device = device or gpu.create_device()

    def render(self, scene: Any, params: Any) -> Frame:
        """One frame with all stages, read back. Raises ValueError for what is not ported."""
        if params.method not in ("warp", "direct", "grid", "pcss"):
            raise ValueError(f"method = {params.method!r}: the port allows warp, direct, grid, pcss")
        return _Drawing(self.device, scene, params).frame()


class _Drawing:
    """One frame."""

    def __init__(self, device: gpu.Device, scene: Any, params: Any) -> None:
        self.device, self.scene, self.params = device, scene, params
        flags = {
            "DEPTH": params.content == "depth",
            "PCF": bool(params.pcf),
            "QUANTIZE": params.quantize is not None,
            "NEAREST": params.policy == "nearest",
        }
        self.soft = params.method == "pcss"
        files = ("shadows.wgsl", "shadows_soft.wgsl") if self.soft else ("shadows.wgsl",)
        self.code = gpu.constants(flags) + gpu.source(*files)
        self.width, self.height = int(scene.camera.width), int(scene.camera.height)
        self.depths = params.content == "depth"
        self.outside = gpu.bits([1.0 if self.depths else 0.0] * 4)
        self.stages: dict[str, list[np.ndarray]] = defaultdict(list)
        self.images: list[Any] = []
        if params.method == "warp":
            size = int(params.map_size)
            images = np.asarray(scene.maps.image, np.float32).reshape(9, size, size)
            self.images = [gpu.upload(device, each.view(np.uint32), FLOAT) for each in images]
        self.points: dict[int, Any] = {}
        if self.soft:
            points = scene.soft.search, scene.soft.filter
            self.points = {6 + k: gpu.upload(device, np.asarray(each)[None]) for k, each in enumerate(points)}

    def frame(self) -> Frame:
        """All passes."""
        place, surface, depth = self._surface()
        sums, bytes_ = self._target(FLOAT), self._target("r8unorm")  # WebGPU's textures are zero at first
        first: Sequence[float] | None = (0.0,) * 4
        samples = self.scene.light_samples
        for sample in samples:
            drawn = self._map(sample)
            camera = {"camera": self.scene.soft if self.soft else sample.camera, "alpha": 1.0 / len(samples)}
            asked = {1: place, 2: drawn, **self.points}
            projected = self._projected(asked, camera)
            self.stages["warp.image"].append(gpu.read_floats(self.device, drawn).astype(np.float64))
            if self.params.accumulation == "float":
                before, sums = sums, self._target(FLOAT)
                self._screen("added", {1: projected, 2: before}, [sums], camera)
            else:
                entry = "softly_blended" if self.soft else "blended"
                self._screen(entry, asked, [bytes_], camera, kind="r8unorm", clear=first)
                first = None
        return self._resolved(place, surface, depth, sums if self.params.accumulation == "float" else bytes_)

    def _projected(self, asked: Mapping[int, Any], camera: Mapping[str, Any]) -> Any:
        """Coordinates and shadow of a sample; its stages are kept."""
        targets = [self._target(FLOATS) for _ in range(2 if self.soft else 1)]
        self._screen("softly_projected" if self.soft else "projected", asked, targets, camera)
        found = [gpu.read_floats(self.device, target).astype(np.float64) for target in targets]
        self.stages["project.coord"].append(found[0][..., :3])
        self.stages["project.shadow"].append(found[0][..., 3])
        if self.soft:
            self.stages["project.blocker"].append(found[1][..., 0])
            self.stages["project.penumbra"].append(found[1][..., 1])
        return targets[0]

    def _resolved(self, place: Any, surface: Any, depth: Any, sums: Any) -> Frame:
        read = gpu.read_floats if self.params.accumulation == "float" else gpu.read_texture
        shadow = read(self.device, sums).astype(np.float64) / (1.0 if self.params.accumulation == "float" else 255.0)
        as_floats = gpu.upload(self.device, shadow)
        picture = self._target(FLOATS)
        self._screen("resolved", {1: place, 2: surface, 3: as_floats}, [picture], {})
        single = len(self.scene.light_samples) == 1
        arrays = {name: each[0] if single else np.stack(each) for name, each in self.stages.items()}
        color = gpu.read_floats(self.device, picture)[..., :3].astype(np.float64)
        depths = gpu.read_depth(self.device, depth).astype(np.float64)
        return Frame(color, depths, arrays | {"accumulate.shadow": np.minimum(shadow, 1.0)})

    # --- Passes ------------------------------------------------------------------------------------------------------

    def _surface(self) -> tuple[Any, Any, Any]:
        """Place, surface and depth of what the camera sees."""
        place, surface, depth = self._target(FLOATS), self._target(FLOATS), self._target("depth32float")
        rows = vertices(self.scene)
        colors = [(place, (0, 0, 0, 0)), (surface, (0, 0, 0, 0))]
        block = self._block(camera=self.scene.camera, offset=self.scene.offset)
        self._draw(("seen", "surface"), SEEN, rows, None, colors, depth, {0: block})
        return place, surface, depth

    def _map(self, sample: Any) -> Any:
        """The map of a sample: warped, rendered, the one of the whole light, or between four of a grid."""
        if self.params.method == "warp":
            return self._warped(sample)
        if self.params.method == "direct":
            return self._rendered(sample.camera, self.scene.offset)
        if self.soft:
            return self._rendered(self.scene.soft, self.scene.offset)
        offsets, fraction = place_in_grid(self.scene, int(self.params.grid_size), sample.seen_offset)
        if not self.params.grid_mix:
            fraction = tuple(float(f >= 0.5) for f in fraction)
        m00, m10, m01, m11 = (self._rendered(self.scene.light.camera, offset) for offset in offsets)
        top, bottom = self._between(m00, m10, fraction[0]), self._between(m01, m11, fraction[0])
        return self._between(top, bottom, fraction[1])

    def _between(self, first: Any, second: Any, share: float) -> Any:
        """Two maps mixed."""
        mixed = gpu.target(self.device, int(self.params.map_size), int(self.params.map_size), FLOAT)
        self._screen("mixed", {1: first, 2: second}, [mixed], {"shares": (0.0, 0.0, 0.0, share)})
        return mixed

    def _rendered(self, camera: Any, offset: Any) -> Any:
        """The map of the caster at an offset: masks of k x k samples a texel are rendered as large and counted."""
        k = 1 if self.depths else int(self.params.map_samples)
        size = k * int(self.params.map_size)
        drawn = gpu.target(self.device, size, size, FLOAT)
        depth = gpu.target(self.device, size, size, "depth32float") if self.depths else None
        caster, block = self.scene.caster, self._block(camera=camera, offset=offset)
        corners, indices = np.asarray(caster.vertices, np.float32), np.asarray(caster.triangles, np.uint32)
        self._draw(("caster", "map"), CASTER, corners, indices, [(drawn, self.outside)], depth, {0: block})
        if k == 1:
            return drawn
        counted = gpu.target(self.device, size // k, size // k, FLOAT)
        self._screen("count", {1: drawn}, [counted], {"samples": k})
        return counted

    def _warped(self, sample: Any) -> Any:
        """The map of a sample from nine: the rows between two maps each, then the result between the rows."""
        maps, size = self.scene.maps, int(self.params.map_size)
        cell, fraction = place_in_cell(maps.positions, sample.seen_offset)
        shares = shares_in_cell(maps.depths, cell, fraction)
        n = 3 * cell[1] + cell[0]
        controls = np.asarray(maps.controls, np.float32)
        indices, rows = mesh_indices(*controls.shape[2:4]), []
        points = controls.reshape(9, -1, 2)[[n, n + 1, n + 3, n + 4]].transpose(1, 0, 2).reshape(-1, 8)
        for pair, share in ((slice(0, 4), shares[0]), (slice(4, 8), shares[1])):
            corners = np.column_stack([points[:, pair], points[:, pair]])
            first = n + (pair.start // 4) * 3
            rows.append(self._warp("row", corners, indices, self.images[first : first + 2], (*shares, share), size))
        result = self._warp("column", points, indices, rows, (*shares, shares[2]), size)
        self._kept(points.reshape(-1, 8), cell, fraction, shares, rows)
        return result

    def _warp(
        self, entry: str, points: np.ndarray, indices: np.ndarray, sources: Sequence[Any], shares: Any, size: int
    ) -> Any:
        drawn = gpu.target(self.device, size, size, FLOAT)
        resources = {0: self._block(shares=shares), 1: sources[0], 2: sources[1]}
        layout = gpu.Vertices(32, POINTS.formats[: 2 if entry == "row" else 4])
        self._draw((entry, "warped"), layout, points, indices, [(drawn, self.outside)], None, resources)
        return drawn

    def _kept(self, points: np.ndarray, cell: Any, fraction: Any, shares: Any, rows: Sequence[Any]) -> None:
        """The stages of a warp."""
        shape = np.shape(self.scene.maps.controls)[2:4]
        storage = wgpu.BufferUsage.STORAGE
        given = gpu.buffer(self.device, np.ascontiguousarray(points, np.float32).tobytes(), storage)
        made = gpu.buffer(self.device, bytes(given.size), storage | wgpu.BufferUsage.COPY_SRC)
        block = self._block(shares=(*shares, 0.0))
        gpu.compute(self.device, self.code, "grids", {0: block, 4: given, 5: made}, len(points))
        grids = gpu.read_buffer(self.device, made, np.float32, 8).reshape(*shape, 4, 2)
        stages = {
            "warp.cell": np.array(cell, np.int32),
            "warp.fraction": np.array(fraction),
            "warp.row_grids": np.stack([grids[:, :, 0], grids[:, :, 1]]),
            "warp.rows": np.stack([gpu.read_floats(self.device, row).astype(np.float64) for row in rows]),
            "warp.grid": grids[:, :, 2],
        }
        if self.scene.maps.depths is not None:
            stages["warp.shares"] = np.array(shares)
        for name, array in stages.items():
            self.stages[name].append(array)

    # --- Calls -------------------------------------------------------------------------------------------------------

    def _target(self, kind: str) -> Any:
        return gpu.target(self.device, self.width, self.height, kind)

    def _draw(
        self,
        entries: tuple[str, str],
        layout: gpu.Vertices,
        corners: np.ndarray,
        indices: np.ndarray | None,
        colors: list[tuple[Any, Any]],
        depth: Any,
        resources: Mapping[int, Any],
    ) -> None:
        """Triangles of corners, one after the other or by indices."""
        kinds = [texture.format for texture, _ in colors]
        pipeline = gpu.pipeline(self.device, self.code, entries, kinds, [layout], depth=depth is not None)
        encoder = self.device.device.create_command_encoder()
        drawing = gpu.begin(encoder, colors, depth)
        drawing.set_pipeline(pipeline)
        drawing.set_bind_group(0, gpu.bind(self.device, pipeline, resources))
        packed = np.ascontiguousarray(corners, np.float32)
        drawing.set_vertex_buffer(0, gpu.buffer(self.device, packed.tobytes(), wgpu.BufferUsage.VERTEX))
        if indices is None:
            drawing.draw(len(corners))
        else:
            drawing.set_index_buffer(gpu.buffer(self.device, indices.tobytes(), wgpu.BufferUsage.INDEX), "uint32")
            drawing.draw_indexed(indices.size)
        drawing.end()
        self.device.device.queue.submit([encoder.finish()])

    def _screen(
        self,
        entry: str,
        resources: Mapping[int, Any],
        targets: Sequence[Any],
        numbers: Mapping[str, Any],
        *,
        kind: str = "",
        clear: Sequence[float] | None = (0, 0, 0, 0),
    ) -> None:
        blend = ADD if kind else None
        kinds = [kind or target.format for target in targets]
        pipeline = gpu.pipeline(self.device, self.code, ("screen", entry), kinds, depth=False, blend=blend)
        gpu.screen(self.device, pipeline, {**resources, 0: self._block(**numbers)}, [(each, clear) for each in targets])

    def _block(
        self,
        camera: Any = None,
        offset: Any = None,
        shares: Sequence[float] = (0.0,) * 4,
        alpha: float = 0.0,
        samples: int = 1,
    ) -> Any:
        """The block `Pass`."""
        scene = self.scene
        camera = scene.camera if camera is None else camera
        moved = (0.0,) * 3 if offset is None else offset_in_world(scene, offset)
        columns = [np.asarray(m, np.float32).T.ravel() for m in (camera.clip_from_view, camera.view_from_world)]
        vectors = [(*moved, float(self.params.bias)), scene.camera.eye, (*scene.light.position, alpha), shares]
        planes = (scene.soft.near, scene.soft.far, scene.soft.nearest, 0.0) if self.soft else (0.0,) * 4
        vectors += [(*scene.background, scene.ambient), planes]
        floats = np.concatenate([*columns, *(np.asarray(vector, np.float32) for vector in vectors)])
        block = floats.astype(np.float32).tobytes() + np.array([samples, 0, 0, 0], np.int32).tobytes()
        return gpu.buffer(self.device, block, wgpu.BufferUsage.UNIFORM)
