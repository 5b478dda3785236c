"""Shadows by image warping on OpenGL: the same inputs as `ibr_ref.shadows.render`, in float32 GLSL.

Scene, parameters and prepared maps are those of an exported case, as case_folder.py reads it; nothing of `ibr_ref` is
imported. Ported are all methods, masks and depths, both policies, every way to compare, and both
ways to accumulate. The passes of a frame:

1. receivers and caster into two attachments: world position and kind; colour and max(0, n . l);
2. per light sample the map, warped, rendered (shadow_maps.py) or of a grid (shadow_grid.py), and one screen-filling triangle
   that projects it onto the positions and is blended with (GL_SRC_ALPHA, GL_ONE), alpha = 1/N;
3. one screen-filling triangle that mixes colour, light and shadow.

With stages everything is float32, and bilinear mixes are made in the shader. Without, the sampler
filters, colours and n . l are bytes, and so are masks, if wished: what an application would do, and what is timed.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from ibr_ref.ports.glsl import gl
from ibr_ref.ports.glsl.shadow_grid import GridMaps
from ibr_ref.ports.glsl.shadow_maps import (
    CasterMaps,
    Pass,
    Programs,
    WarpedMaps,
    column_major,
    create_warped_maps,
)
from ibr_ref.ports.glsl.shadow_soft import SoftMap
from ibr_ref.ports.shadow_scene import offset_in_world, place_in_cell, shares_in_cell, vertices

FAST = {"place": (4, "f4"), "surface": (4, "f1")}
STAGES = {"place": (4, "f4"), "surface": (4, "f4")}


@dataclass
class Prepared:
    """A scene with its maps uploaded and its programs linked: `draw` is a whole frame, as often as one likes."""

    device: gl.Device
    scene: Any
    params: Any
    source: WarpedMaps | CasterMaps | GridMaps | SoftMap
    target: gl.Target
    surface: moderngl.VertexArray
    project: moderngl.VertexArray
    coordinates: moderngl.VertexArray | None
    """The projection that writes numbers, for the stages."""
    resolve: moderngl.VertexArray
    accumulated: Pass
    picture: gl.Target
    owned: list[Any]

    def draw(self) -> None:
        """Submit a frame."""
        self.device.use()
        self._draw_surface()
        self.accumulated.begin()
        for sample in self.scene.light_samples:
            self._draw_map(sample)
            self._set_projection(self.project.program, sample)
            self.accumulated.fbo.use()
            self.device.ctx.enable_only(moderngl.BLEND)
            self.device.ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE
            self.project.render(moderngl.TRIANGLES, vertices=3)
        self._draw_picture()

    def draw_maps(self) -> None:
        """The maps of all samples alone."""
        self.device.use()
        for sample in self.scene.light_samples:
            self._draw_map(sample)

    def seconds(self) -> float:
        """Time of one frame, from the first call to the return of glFinish, without read-back."""
        return gl.frame_seconds(self.device, self.draw)

    def map_seconds(self) -> float:
        """The same of the maps alone."""
        return gl.frame_seconds(self.device, self.draw_maps)

    def read(self) -> gl.Frame:
        """The frame that was drawn last; its stages are drawn anew, one sample after another."""
        color = self.picture.read("color")
        color = color[..., :3] / 255.0 if color.dtype == np.uint8 else color[..., :3].astype(np.float64)
        depth = self.target.read_depth().astype(np.float64)
        return gl.Frame(color=color, depth=depth, stages={} if self.coordinates is None else self._stages())

    def read_map(self) -> np.ndarray:
        """(S, S) the last sample's map, as it was drawn last."""
        return self.source.result.read() if isinstance(self.source, WarpedMaps) else self.source.read()

    def release(self) -> None:
        """Give everything back to the driver."""
        for item in (self.source, self.target, self.picture, self.accumulated, *self.owned):
            item.release()

    def _draw_surface(self) -> None:
        self.target.begin()
        self.device.ctx.enable_only(moderngl.DEPTH_TEST)
        self.device.ctx.depth_func = "<"
        program, camera = self.surface.program, self.scene.camera
        program["clip_from_view"].write(column_major(camera.clip_from_view))
        program["view_from_world"].write(column_major(camera.view_from_world))
        program["offset"].value = offset_in_world(self.scene, self.scene.offset)
        program["eye"].value = tuple(np.asarray(camera.eye, float).tolist())
        program["light"].value = tuple(np.asarray(self.scene.light.position, float).tolist())
        self.surface.render(moderngl.TRIANGLES)

    def _draw_map(self, sample: Any) -> None:
        if isinstance(self.source, CasterMaps):
            self.source.draw(sample.camera, self.scene.offset)
        elif isinstance(self.source, (GridMaps, SoftMap)):
            self.source.draw(sample)
        else:
            cell, fraction = place_in_cell(self.scene.maps.positions, sample.seen_offset)
            self.source.draw(cell, shares_in_cell(self.scene.maps.depths, cell, fraction))

    def _set_projection(self, program: moderngl.Program, sample: Any) -> None:
        camera = self.scene.soft if isinstance(self.source, SoftMap) else sample.camera
        program["clip_from_view"].write(column_major(camera.clip_from_view))
        program["view_from_world"].write(column_major(camera.view_from_world))
        for name, value in (("bias", float(self.params.bias)), ("alpha", 1.0 / len(self.scene.light_samples))):
            if name in program:
                program[name].value = value
        self.target.textures["place"].use(0)
        self.source.texture.use(1)
        if isinstance(self.source, SoftMap):
            self.source.ask(program)

    def _draw_picture(self) -> None:
        self.picture.fbo.use()
        self.device.ctx.enable_only(moderngl.NOTHING)
        self.resolve.program["ambient"].value = float(self.scene.ambient)
        self.resolve.program["background"].value = tuple(np.asarray(self.scene.background, float).tolist())
        sources = (self.target.textures["place"], self.target.textures["surface"], self.accumulated.texture)
        for unit, texture in enumerate(sources):
            texture.use(unit)
        self.resolve.render(moderngl.TRIANGLES, vertices=3)

    def _stages(self) -> dict[str, np.ndarray]:
        """Maps and projections per sample, as the specification groups them, and their sum."""
        assert self.coordinates is not None, "prepared without stages"
        width, height = self.picture.fbo.size
        soft = isinstance(self.source, SoftMap)
        attachments = {"result": (4, "f4"), **({"softness": (4, "f4")} if soft else {})}
        result = gl.create_target(self.device, width, height, attachments)
        stages: dict[str, list[np.ndarray]] = defaultdict(list)
        for sample in self.scene.light_samples:
            self._draw_map(sample)
            self._set_projection(self.coordinates.program, sample)
            result.fbo.use()
            self.device.ctx.enable_only(moderngl.NOTHING)
            self.coordinates.render(moderngl.TRIANGLES, vertices=3)
            projected = result.read("result").astype(np.float64)
            stages["warp.image"].append(self.read_map())
            if isinstance(self.source, WarpedMaps):
                for name, array in self._warp_stages(self.source, sample).items():
                    stages[name].append(array)
            stages["project.coord"].append(projected[..., :3])
            stages["project.shadow"].append(projected[..., 3])
            if soft:
                softness = result.read("softness").astype(np.float64)
                stages["project.blocker"].append(softness[..., 0])
                stages["project.penumbra"].append(softness[..., 1])
        result.release()
        single = len(self.scene.light_samples) == 1
        arrays = {name: each[0] if single else np.stack(each) for name, each in stages.items()}
        return arrays | {"accumulate.shadow": np.minimum(self.accumulated.read(), 1.0)}

    def _warp_stages(self, source: WarpedMaps, sample: Any) -> dict[str, np.ndarray]:
        """Where the sample's map lies among the nine, the meshes and the rows."""
        cell, fraction = place_in_cell(self.scene.maps.positions, sample.seen_offset)
        rows = np.stack([row.read() for row in source.rows])
        depths = self.scene.maps.depths
        shares = shares_in_cell(depths, cell, fraction)
        row_grids, grid = source.grids(cell, shares)
        paced = {} if depths is None else {"warp.shares": np.array(shares)}
        return paced | {
            "warp.cell": np.array(cell, np.int32),
            "warp.fraction": np.array(fraction),
            "warp.row_grids": row_grids,
            "warp.rows": rows,
            "warp.grid": grid,
        }


class Port:
    """The port on one device. Programs are kept, so that a second scene of the same kind links nothing."""

    def __init__(self, device: gl.Device | None = None) -> None:
        self.device = device or gl.create_device()
        self._programs = Programs(self.device)

    def render(self, scene: Any, params: Any, **options: Any) -> gl.Frame:
        """One frame, read back. The options are those of `prepare`."""
        prepared = self.prepare(scene, params, **options)
        try:
            prepared.draw()
            return prepared.read()
        finally:
            prepared.release()

    def maps(self, scene: Any, params: Any) -> np.ndarray:
        """Stage 1: (3, 3, S, S) maps of the caster at the nine positions, seen from the light's centre."""
        self.device.use()
        caster = CasterMaps(self.device, self._programs, scene, params)
        images = []
        for offset in scene.maps.positions.reshape(9, 2):
            caster.draw(scene.light.camera, offset)
            images.append(caster.read())
        caster.release()
        return np.stack(images).reshape(3, 3, *images[0].shape)

    def prepare(self, scene: Any, params: Any, *, stages: bool = True, texels: str = "f1") -> Prepared:
        """Upload and link.

        texels: "f1" or "f4", what warped masks are stored as without stages.

        Raises ValueError for methods and maps that are not ported.
        """
        self.device.use()
        _check(params)
        ctx, camera = self.device.ctx, scene.camera
        size = int(camera.width), int(camera.height)
        buffer = ctx.buffer(vertices(scene).tobytes())
        layout = [(buffer, "3f 3f 3f 1f", "in_position", "in_normal", "in_color", "in_caster")]
        surface = ctx.vertex_array(self._programs.get("surface", "surface"), layout)
        kind, flags = ("soft", []) if params.method == "pcss" else ("project", _flags(params, stages))
        project = ctx.vertex_array(self._programs.get("screen", kind, *flags), [])
        coordinates = ctx.vertex_array(self._programs.get("screen", kind, "COORD", *flags), []) if stages else None
        resolve = ctx.vertex_array(self._programs.get("screen", "resolve"), [])
        vaos = [vao for vao in (surface, project, coordinates, resolve) if vao is not None]
        source = self._source(scene, params, stages, "f4" if stages else texels)
        return Prepared(
            device=self.device,
            scene=scene,
            params=params,
            source=source,
            target=gl.create_target(self.device, *size, STAGES if stages else FAST),
            surface=surface,
            project=project,
            coordinates=coordinates,
            resolve=resolve,
            accumulated=Pass.of(self.device, *size, "f4" if params.accumulation == "float" else "f1"),
            picture=gl.create_target(self.device, *size, {"color": (4, "f4" if stages else "f1")}),
            owned=[*vaos, buffer],
        )

    def _source(
        self, scene: Any, params: Any, stages: bool, texels: str
    ) -> WarpedMaps | CasterMaps | GridMaps | SoftMap:
        """Where the map of a sample comes from."""
        if params.method == "warp":
            return create_warped_maps(self.device, self._programs, scene.maps, params, exact=stages, texels=texels)
        kinds: dict[str, type[CasterMaps | GridMaps | SoftMap]] = {
            "direct": CasterMaps,
            "grid": GridMaps,
            "pcss": SoftMap,
        }
        return kinds[params.method](self.device, self._programs, scene, params)


def _flags(params: Any, stages: bool) -> list[str]:
    """The #defines of the projection."""
    flags = {
        "DEPTH": params.content == "depth",
        "PCF": params.pcf,
        "QUANTIZE": params.quantize is not None,
        "EXACT": stages,
    }
    return [name for name, present in flags.items() if present]


def _check(params: Any) -> None:
    """Refuse what is not ported."""
    if params.method not in ("warp", "direct", "grid", "pcss"):
        raise ValueError(f"method = {params.method!r}: the port allows warp, direct, grid, pcss")
