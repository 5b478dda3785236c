"""The maps of the shadow port: the caster seen from a light sample, and the warp of nine such maps, as OpenGL passes.

Row 0 of every map is its top and the first in memory, so that a control point (u, v) is drawn at NDC (2u - 1, 2v - 1). A
warp is a control mesh of 2 (R - 1)(C - 1) textured triangles. Two images that are warped to the same mesh and mixed are one
draw call with two fetches, for which nothing is stored in between: "dissolve" takes three draw calls, as "nearest" does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import moderngl
import numpy as np

from ibr_ref.ports.glsl import gl
from ibr_ref.ports.shadow_scene import mesh_indices, offset_in_world


class Programs:
    """Shaders of this folder by file names and #defines, linked once."""

    def __init__(self, device: gl.Device) -> None:
        self._device = device
        self._linked: dict[tuple[str, ...], moderngl.Program] = {}

    def get(self, vertex: str, fragment: str, *flags: str) -> moderngl.Program:
        """The program of shadows_<vertex>.vert and shadows_<fragment>.frag with the flags defined."""
        key = (vertex, fragment, *flags)
        if key not in self._linked:
            flags = (*flags, "ZERO_TO_ONE") if self._device.zero_to_one else flags
            head = "#version 450 core\n" + "".join(f"#define {flag}\n" for flag in flags)
            sources = [head + gl.source(f"shadows_{name}") for name in (f"{vertex}.vert", f"{fragment}.frag")]
            self._device.use()
            self._linked[key] = self._device.ctx.program(vertex_shader=sources[0], fragment_shader=sources[1])
        return self._linked[key]

    def capture(self, vertex: str, varying: str, *flags: str) -> moderngl.Program:
        """The vertex shader alone with CAPTURE defined, for transform feedback of one varying."""
        key = (vertex, varying, "CAPTURE", *flags)
        if key not in self._linked:
            head = "#version 450 core\n" + "".join(f"#define {flag}\n" for flag in ("CAPTURE", *flags))
            source = head + gl.source(f"shadows_{vertex}.vert")
            self._device.use()
            self._linked[key] = self._device.ctx.program(vertex_shader=source, varyings=[varying])
        return self._linked[key]


def column_major(matrix: np.ndarray) -> bytes:
    """A (4, 4) matrix as a mat4 uniform takes it."""
    return np.asarray(matrix, np.float32).T.tobytes()


@dataclass
class Pass:
    """A target without a depth buffer, one channel, in memory order: something to draw into and then to fetch from."""

    fbo: moderngl.Framebuffer
    texture: moderngl.Texture

    @classmethod
    def of(cls, device: gl.Device, width: int, height: int, dtype: str) -> Pass:
        """`dtype` is moderngl's: "f1" or "f4"."""
        texture = device.ctx.texture((width, height), 1, dtype=dtype)
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return cls(device.ctx.framebuffer(color_attachments=[texture]), texture)

    def begin(self, value: float = 0.0) -> None:
        """Bind and clear."""
        self.fbo.use()
        self.fbo.clear(value, 0.0, 0.0, 0.0)

    def read(self) -> np.ndarray:
        """(rows, columns) float64; bytes as k / 255."""
        data = np.frombuffer(self.texture.read(alignment=1), np.uint8 if self.texture.dtype == "f1" else np.float32)
        numbers = data.reshape(self.texture.height, self.texture.width).astype(np.float64)
        return numbers / 255.0 if self.texture.dtype == "f1" else numbers

    def release(self) -> None:
        """Give both back to the driver."""
        self.fbo.release()
        self.texture.release()


class CasterMaps:
    """Stage 1: maps of the caster alone; masks of k x k samples a texel are rendered as large and counted."""

    def __init__(self, device: gl.Device, programs: Programs, scene: Any, params: Any) -> None:
        self._scene, self._device, self._depth = scene, device, params.content == "depth"
        flags = ("DEPTH",) if self._depth else ()
        self._program = programs.get("map", "map", *flags)
        vertices = device.ctx.buffer(np.asarray(scene.caster.vertices, np.float32).tobytes())
        indices = device.ctx.buffer(np.asarray(scene.caster.triangles, np.uint32).tobytes())
        vao = device.ctx.vertex_array(self._program, [(vertices, "3f", "in_position")], index_buffer=indices)
        self._samples = 1 if self._depth else int(params.map_samples)
        self._vao, self._size = vao, int(params.map_size) * self._samples
        if self._depth:
            self._target: Any = gl.create_target(device, self._size, self._size, {"map": (1, "f4")})
            self._target.clears = {"map": (1.0,)}
            self.texture = self._target.textures["map"]
            self.texture.repeat_x = self.texture.repeat_y = False
        else:
            self._target = Pass.of(device, self._size, self._size, "f1")
            self.texture = self._target.texture
        self._owned = [vao, vertices, indices, self._target]
        if self._samples > 1:
            self._counted = Pass.of(device, int(params.map_size), int(params.map_size), "f4")
            self._count = device.ctx.vertex_array(programs.get("screen", "count"), [])
            self.texture = self._counted.texture
            self._owned += [self._counted, self._count]

    def draw(self, camera: Any, offset: np.ndarray) -> None:
        """The map of the object at `offset`, as the camera of a light sample sees it."""
        self._program["clip_from_view"].write(column_major(camera.clip_from_view))
        self._program["view_from_world"].write(column_major(camera.view_from_world))
        self._program["offset"].value = offset_in_world(self._scene, offset)
        self._target.begin()
        self._device.ctx.enable_only(moderngl.DEPTH_TEST if self._depth else moderngl.NOTHING)
        self._device.ctx.depth_func = "<"
        self._vao.render(moderngl.TRIANGLES)
        if self._samples > 1:
            self._count.program["samples"].value = self._samples
            self._target.texture.use(0)
            self._counted.begin()
            self._device.ctx.enable_only(moderngl.NOTHING)
            self._count.render(moderngl.TRIANGLES, vertices=3)

    def read(self) -> np.ndarray:
        """(S, S) float64 of the map that was drawn last."""
        if self._samples > 1:
            return self._counted.read()
        return np.asarray(self._target.read("map")[..., 0] if self._depth else self._target.read(), np.float64)

    def release(self) -> None:
        """Give everything back to the driver."""
        for item in self._owned:
            item.release()


@dataclass
class WarpedMaps:
    """Stage 3: the map for any offset by three draw calls, from nine maps and their control points."""

    device: gl.Device
    images: list[moderngl.Texture]
    """Nine, the map for x_i, y_j at 3 j + i."""
    rows: list[Pass]
    result: Pass
    row_vaos: list[moderngl.VertexArray | None]
    """By the number of the first map: the mesh between it and the next along x."""
    column_vaos: dict[int, moderngl.VertexArray]
    """By the number of map 00: the mesh between its row and the next."""
    capture_vaos: dict[tuple[int, ...], moderngl.VertexArray]
    """By the numbers of the two or four maps: the mesh between them, as transform feedback hands it back."""
    shape: tuple[int, int]
    """Rows and columns of the meshes."""
    nearest: bool
    outside: float
    owned: list[Any] = field(default_factory=list)

    @property
    def texture(self) -> moderngl.Texture:
        """The map that was warped last."""
        return self.result.texture

    def draw(self, cell: Sequence[int], shares: tuple[float, ...]) -> None:
        """The rows between two maps each, then the result between the rows; shares: those of `shares_in_cell`."""
        first = 3 * cell[1] + cell[0]
        self.device.ctx.enable_only(moderngl.NOTHING)
        for row, number, share in zip(self.rows, (first, first + 3), shares[:2], strict=True):
            own = (share, share, shares[2])
            self._warp(row, self.row_vaos[number], self.images[number], self.images[number + 1], own, share)
        top, bottom = self.rows
        self._warp(self.result, self.column_vaos[first], top.texture, bottom.texture, shares, shares[2])

    def grids(self, cell: Sequence[int], shares: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
        """The meshes (2, R, C, 2) of the rows and (R, C, 2) of the result, as the vertex shader makes them."""
        n = 3 * cell[1] + cell[0]
        upper, lower, across = shares
        rows = [
            self._captured((n, n + 1), (upper, upper, across)),
            self._captured((n + 3, n + 4), (lower, lower, across)),
        ]
        return np.stack(rows), self._captured((n, n + 1, n + 3, n + 4), shares)

    def _captured(self, numbers: tuple[int, ...], shares: tuple[float, ...]) -> np.ndarray:
        vao, count = self.capture_vaos[numbers], self.shape[0] * self.shape[1]
        result = self.device.ctx.buffer(reserve=8 * count)
        vao.program["shares"].value = shares
        self.result.fbo.use()  # a draw call wants a complete frame buffer, even if nothing is rasterized
        vao.transform(result, moderngl.POINTS, vertices=count)
        points = np.frombuffer(result.read(), np.float32).reshape(*self.shape, 2).copy()
        result.release()
        return points

    def _warp(
        self,
        target: Pass,
        vao: moderngl.VertexArray,
        first: moderngl.Texture,
        second: moderngl.Texture,
        shares: tuple[float, ...],
        share: float,
    ) -> None:
        vao.program["shares"].value = shares
        if self.nearest:
            (first if share < 0.5 else second).use(0)
        else:
            vao.program["share"].value = share
            first.use(0)
            second.use(1)
        target.begin(self.outside)
        vao.render(moderngl.TRIANGLES)

    def release(self) -> None:
        """Give everything back to the driver."""
        for item in [*self.owned, *self.rows, self.result, *self.images]:
            item.release()


def create_warped_maps(
    device: gl.Device, programs: Programs, maps: Any, params: Any, *, exact: bool, texels: str
) -> WarpedMaps:
    """Upload `maps` (`image` (3, 3, S, S), `controls` (3, 3, R, C, 2)).

    exact: bilinear mixes in the shader. texels: "f4", or "f1" for bytes; depths are always floats.
    """
    dtype = "f4" if params.content == "depth" else texels
    image, controls = np.asarray(maps.image, float), np.asarray(maps.controls, float)
    size, (rows, columns) = image.shape[-1], controls.shape[2:4]
    flags = [*(["EXACT"] if exact else []), *(["NEAREST"] if params.policy == "nearest" else [])]
    points = device.ctx.buffer(controls.reshape(9, -1, 2).transpose(1, 0, 2).astype(np.float32).tobytes())
    indices = device.ctx.buffer(mesh_indices(rows, columns).tobytes())

    def mesh(program: moderngl.Program, numbers: Sequence[int], *, indexed: bool = True) -> moderngl.VertexArray:
        names = ("in_a", "in_b", "in_c", "in_d")[: len(numbers)]
        fields = " ".join("2f" if number in numbers else "8x" for number in range(9))
        return device.ctx.vertex_array(program, [(points, fields, *names)], index_buffer=indices if indexed else None)

    row_program = programs.get("warp", "warp", *flags)
    column_program = programs.get("warp", "warp", "COLUMN", *flags)
    row_vaos = [mesh(row_program, (n, n + 1)) if n % 3 < 2 else None for n in range(9)]
    column_vaos = {n: mesh(column_program, (n, n + 1, n + 3, n + 4)) for n in (0, 1, 3, 4)}
    row_capture, column_capture = programs.capture("warp", "place"), programs.capture("warp", "place", "COLUMN")
    capture_vaos: dict[tuple[int, ...], moderngl.VertexArray] = {
        (n, n + 1): mesh(row_capture, (n, n + 1), indexed=False) for n in range(9) if n % 3 < 2
    }
    for n in (0, 1, 3, 4):
        numbers = (n, n + 1, n + 3, n + 4)
        capture_vaos[numbers] = mesh(column_capture, numbers, indexed=False)
    return WarpedMaps(
        device=device,
        images=[gl.upload(device, each, dtype=dtype) for each in image.reshape(9, size, size)],
        rows=[Pass.of(device, size, size, dtype) for _ in range(2)],
        result=Pass.of(device, size, size, dtype),
        row_vaos=row_vaos,
        column_vaos=column_vaos,
        capture_vaos=capture_vaos,
        shape=(rows, columns),
        nearest=params.policy == "nearest",
        outside=0.0 if params.content == "mask" else 1.0,
        owned=[*(vao for vao in row_vaos if vao), *column_vaos.values(), *capture_vaos.values(), points, indices],
    )
