"""Splatting of depth images on OpenGL: the same inputs as `ibr_ref.splatting.render`, in float32 GLSL.

The scene is that of an exported case, as case_folder.py reads it; nothing of `ibr_ref` is imported. One draw call a
reference image, one vertex a valid pixel, which fetches its depth, colour and normal from a texture: the reference images
themselves, as an atlas is a matter of how many textures a device binds. Two primitives:

- "points": point sprites, one vertex each, the splat as gl_PointSize. A driver clamps that (1 to 255 on llvmpipe), may snap
  it, and culls a sprite by its centre: so the viewport is larger than the picture by half the largest width on every side.
- "quads": two triangles around the centre, snapped to 1/256 pixel in the shader; every corner is snapped once more by the
  rasterizer. Indexed, the pixel stored four times: on llvmpipe instances of one quad take 1.3 to 1.5 times as long, and a
  geometry shader is no faster.

Colours are stored as bytes, as in the files that reference images come from, or in a texture of their own if they are not
multiples of 1/255.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from ibr_ref.ports.glsl import gl
from ibr_ref.ports.glsl.splatting_ellipses import Averages

FAST = {"color": (4, "f1")}
STAGES = {"color": (4, "f4"), "splat": (1, "i4")}
VARYINGS = {"window": 2, "depth": 1, "width": 1, "color": 3}
"""What transform feedback hands back of a vertex, and how many numbers each has."""
ELLIPSES = {**VARYINGS, "covariance": 3, "amplitude": 1, "along": 1}
"""The same of ellipses."""
CORNERS = {"points": 1, "quads": 4}
"""Vertices a splat, by primitive."""


@dataclass
class _Draw:
    """The points of one reference image, ready to be submitted."""

    vao: moderngl.VertexArray
    uniforms: moderngl.Buffer
    textures: list[moderngl.Texture]
    pixels: np.ndarray
    owned: list[Any]

    def bind(self) -> None:
        """Its uniforms and textures."""
        self.uniforms.bind_to_uniform_block(0)
        for unit, texture in enumerate(self.textures):
            texture.use(unit)


@dataclass
class Prepared:
    """A scene with its textures uploaded and its programs linked: `draw` is a whole frame, as often as one likes."""

    device: gl.Device
    target: gl.Target
    draws: list[_Draw]
    mode: int
    stages: bool
    vertices: dict[str, np.ndarray]
    averages: Averages | None = None
    """Of ellipses."""

    def draw(self) -> None:
        """Submit a frame: clear, then per reference image its uniforms, its texture and one draw call."""
        if self.averages is not None:
            self.averages.draw()
            return
        self.target.begin()
        self.device.ctx.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        self.device.ctx.depth_func = "<"
        for draw in self.draws:
            draw.bind()
            draw.vao.render(self.mode)

    def seconds(self) -> float:
        """Time of one frame, from the first call to the return of glFinish, without read-back."""
        return gl.frame_seconds(self.device, self.draw)

    def read(self) -> gl.Frame:
        """The frame that was drawn last."""
        color = self.target.read("color")
        color = color[..., :3] / 255.0 if color.dtype == np.uint8 else color[..., :3].astype(np.float64)
        depth = self.averages.read_depth() if self.averages else self.target.read_depth().astype(np.float64)
        if not self.stages:
            return gl.Frame(color=color, depth=depth)
        if self.averages:
            return gl.Frame(color=color, depth=depth, stages=self.vertices | self.averages.stages())
        shown = {"raster.splat": self.target.read("splat")[..., 0], "raster.depth": depth.copy()}
        return gl.Frame(color=color, depth=depth, stages=self.vertices | shown)

    def release(self) -> None:
        """Give everything back to the driver."""
        self.target.release()
        if self.averages:
            self.averages.release()
        for draw in self.draws:
            for item in draw.owned:
                item.release()


class Port:
    """The port on one device. Programs are kept, so that a second scene of the same kind links nothing."""

    def __init__(self, device: gl.Device | None = None) -> None:
        self.device = device or gl.create_device()
        self._programs: dict[str, moderngl.Program] = {}

    def render(self, scene: Any, params: Any, **options: Any) -> gl.Frame:
        """One frame, read back. The options are those of `prepare`."""
        prepared = self.prepare(scene, params, **options)
        try:
            prepared.draw()
            return prepared.read()
        finally:
            prepared.release()

    def prepare(
        self,
        scene: Any,
        params: Any,
        *,
        stages: bool = True,
        primitive: str | None = None,
    ) -> Prepared:
        """Upload `scene`, compile for `params`; `stages=False` is the variant that is timed: RGBA8 and depth alone.

        primitive: None for point sprites where the driver has all widths, otherwise quads. Raises ValueError for what is
        not ported.
        """
        self.device.use()
        sizes = self.device.ctx.info["GL_POINT_SIZE_RANGE"]
        elliptic = params.shape == "ellipse"
        if primitive is None:
            primitive = (
                "points" if not elliptic and sizes[0] <= params.min_width <= params.max_width <= sizes[1] else "quads"
            )
        _check(params, primitive, sizes)
        width, height = int(scene.camera.width), int(scene.camera.height)
        target = gl.create_target(self.device, width, height, STAGES if stages else FAST)
        target.clears = {"color": (*map(float, scene.background), 0.0), "splat": (-1,)}
        guard = int(np.ceil(params.max_width / 2)) if primitive == "points" else 0
        target.fbo.viewport = (-guard, -guard, width + 2 * guard, height + 2 * guard)
        flags = {"QUADS": primitive == "quads", "DISC": params.shape == "disc", "STAGES": stages or elliptic}
        flags |= {"ZERO_TO_ONE": self.device.zero_to_one, "ELLIPSE": elliptic}
        passes = [{"NEAREST": True}, {}] if elliptic else [{}]
        drawn = [self._draws(scene, params, flags | each, primitive, guard) for each in passes]
        vertices = self._vertices(scene, target, drawn[0], elliptic) if stages else {}
        mode = moderngl.POINTS if primitive == "points" else moderngl.TRIANGLES
        return Prepared(
            device=self.device,
            target=target,
            draws=[draw for draws in drawn for draw in draws],
            mode=mode,
            stages=stages,
            vertices=vertices,
            averages=Averages(self.device, scene, target, *drawn) if elliptic else None,
        )

    def _draws(self, scene: Any, params: Any, flags: dict[str, bool], primitive: str, guard: int) -> list[_Draw]:
        """Of all images, by one program each."""
        draws: list[_Draw] = []
        for image in scene.images:
            program = self._program(_defines(scene, image, flags))
            block = _uniforms(scene, params, image, guard, first=sum(len(draw.pixels) for draw in draws))
            draws.append(self._image(image, scene.light is not None or flags["ELLIPSE"], program, block, primitive))
        return draws

    def _image(self, image: Any, lit: bool, program: moderngl.Program, block: bytes, primitive: str) -> _Draw:
        """Buffers and textures of one reference image; an image without a point draws nothing."""
        ctx = self.device.ctx
        texels = _texels(image, lit=lit)
        pixels = np.argwhere(np.asarray(image.mask)).astype(np.int32)
        columns_rows = np.repeat(pixels[:, ::-1], CORNERS[primitive], axis=0).astype(np.uint16)
        height, width, words = texels.shape
        texture = ctx.texture((width, height), words, texels.tobytes(), alignment=4, dtype="u4")
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        textures = [texture]
        if not _in_bytes(image):
            textures.append(gl.upload(self.device, image.color, filtered=False))
        uniforms = ctx.buffer(block)
        owned: list[Any] = [*textures, uniforms, ctx.buffer(columns_rows.tobytes() or b"\0\0\0\0")]
        layout = [(owned[-1], "2u2", "pixel")]
        if primitive == "points":
            vao = ctx.vertex_array(program, layout)
            vao.vertices = len(pixels)
        else:
            owned.append(ctx.buffer(_quad_indices(len(pixels)).tobytes() or b"\0\0\0\0"))
            vao = ctx.vertex_array(program, layout, index_buffer=owned[-1], index_element_size=4)
            vao.vertices = 6 * len(pixels)
        return _Draw(vao=vao, uniforms=uniforms, textures=textures, pixels=pixels, owned=[vao, *owned])

    def _program(self, defines: str, varyings: Sequence[str] = ()) -> moderngl.Program:
        """The linked program for these #defines; with varyings for transform feedback, of the vertex stage alone."""
        if defines not in self._programs:
            kinds = "splatting.vert", "splatting_ellipse.frag" if "#define ELLIPSE" in defines else "splatting.frag"
            vertex, fragment = (defines + gl.source(kind) for kind in kinds)
            self._programs[defines] = self.device.ctx.program(
                vertex_shader=vertex, fragment_shader=None if varyings else fragment, varyings=tuple(varyings)
            )
        return self._programs[defines]

    def _vertices(self, scene: Any, target: gl.Target, draws: list[_Draw], elliptic: bool) -> dict[str, np.ndarray]:
        """The stages "vertex.*", as the vertex shader made them."""
        target.fbo.use()  # a draw call wants a complete frame buffer, even if nothing is rasterized
        varyings, flags = ELLIPSES if elliptic else VARYINGS, {"CAPTURE": True, "ELLIPSE": elliptic}
        programs = [self._program(_defines(scene, image, flags), tuple(varyings)) for image in scene.images]
        numbers = sum(varyings.values())
        pairs = zip(draws, programs, strict=True)
        rows = np.concatenate([self._capture(draw, program, numbers) for draw, program in pairs])
        window, depth, width, color, *shape = np.split(rows, np.cumsum(list(varyings.values()))[:-1], axis=1)
        dropped = width < 0.0
        names = ("vertex.covariance", "vertex.amplitude", "vertex.distance")
        shapes = [np.where(dropped, np.nan, each) for each in shape]
        source = [np.pad(draw.pixels, ((0, 0), (1, 0)), constant_values=number) for number, draw in enumerate(draws)]
        return {
            "vertex.window": np.where(dropped, np.nan, window),
            "vertex.depth": np.where(dropped, np.nan, depth)[:, 0],
            "vertex.width": np.where(dropped, 0.0, width)[:, 0],
            "vertex.color": color,
            "vertex.source": np.concatenate(source).astype(np.int32),
            **{name: each if name == names[0] else each[:, 0] for name, each in zip(names, shapes, strict=False)},
        }

    def _capture(self, draw: _Draw, program: moderngl.Program, numbers: int) -> np.ndarray:
        """(points, numbers) float32 of one image by transform feedback."""
        ctx, count = self.device.ctx, len(draw.pixels)
        if count == 0:
            return np.zeros((0, numbers), np.float32)
        source = ctx.buffer(draw.pixels[:, ::-1].astype(np.uint16).tobytes())
        result = ctx.buffer(reserve=count * numbers * 4)
        vao = ctx.vertex_array(program, [(source, "2u2", "pixel")])
        draw.bind()
        vao.transform(result, moderngl.POINTS, vertices=count)
        rows = np.frombuffer(result.read(), dtype=np.float32).reshape(count, numbers).copy()
        for item in (vao, source, result):
            item.release()
        return rows


def _in_bytes(image: Any) -> bool:
    """Whether all colours are multiples of 1/255."""
    scaled = 255.0 * np.asarray(image.color)
    return bool(np.abs(scaled - np.rint(scaled)).max() <= 1e-6)


def _texels(image: Any, *, lit: bool) -> np.ndarray:
    """(H, W, 2) uint32, lit 4 (three would be four as well): the depth's bits, the colour's bytes, the normal's bytes."""
    texels = np.zeros((*np.shape(image.depth), 4 if lit else 2), np.uint32)
    texels[..., 0] = np.asarray(image.depth, np.float32).view(np.uint32)
    texels[..., 1] = _word(np.rint(255.0 * np.asarray(image.color)))
    if lit:
        texels[..., 2] = _word(image.normals)
    return texels


def _word(three: np.ndarray) -> np.ndarray:
    """(H, W) uint32 of (H, W, 3) bytes, the first one lowest."""
    three = np.asarray(three, np.uint32)
    return np.asarray(three[..., 0] | three[..., 1] << 8 | three[..., 2] << 16)


def _quad_indices(count: int) -> np.ndarray:
    """Two triangles each of `count` quads of four vertices, which are numbered by row, then column."""
    return np.asarray(4 * np.arange(count)[:, None] + np.array([0, 1, 2, 2, 1, 3]), np.uint32)


def _uniforms(scene: Any, params: Any, image: Any, guard: int, first: int) -> bytes:
    """The std140 block `Splats`, computed in float64, rounded once."""
    camera, light, reference = scene.camera, scene.light, image.camera
    (f_x, skew, c_x), (_, f_y, c_y), _ = np.asarray(reference.intrinsics, float).tolist()
    width, height = camera.width, camera.height
    matrices = [reference.world_from_view, camera.view_from_world, camera.clip_from_view]
    vectors = [(c_x, c_y, 1.0 / f_x, 1.0 / f_y), (skew, reference.perspective, camera.perspective), camera.eye]
    vectors += [(), ()] if light is None else [light.homogeneous, (light.ambient, light.diffuse, light.specular)]
    vectors += [(params.alpha, params.beta, params.gamma, params.delta), (params.min_width, params.max_width)]
    vectors += [(width, height, width / (width + 2 * guard), height / (height + 2 * guard))]
    vectors += [(params.footprint, params.low_pass, params.cutoff, params.depth_tolerance)]
    columns = [np.asarray(matrix, np.float32).T.ravel() for matrix in matrices]
    padded = [np.pad(np.asarray(vector, np.float32), (0, 4 - len(vector))) for vector in vectors]
    return np.concatenate(columns + padded).tobytes() + np.array([first, 0, 0, 0], np.int32).tobytes()


def _defines(scene: Any, image: Any, flags: dict[str, bool]) -> str:
    """The lines in front of a shader's source: the flags that are set, and what the light and the image ask for."""
    light = scene.light
    flags = flags | {"LIT": light is not None, "HAS_SPECULAR": light is not None and light.specular > 0.0}
    flags = flags | {"COLOR_TEXTURE": not _in_bytes(image)}
    lines = [f"#define {name}\n" for name, present in flags.items() if present]
    lines += [] if light is None else [f"#define EXPONENT {light.exponent}\n"]
    return "#version 450 core\n" + "".join(lines)


def _check(params: Any, primitive: str, sizes: tuple[float, float]) -> None:
    """Refuse what is not ported."""
    if primitive not in CORNERS:
        raise ValueError(f"primitive = {primitive!r}: the port allows {', '.join(CORNERS)}")
    if params.shape not in ("square", "disc", "ellipse"):
        raise ValueError(f"shape = {params.shape!r}: the port allows square, disc, ellipse")
    if primitive == "points" and params.shape == "ellipse":
        raise ValueError("primitive = 'points': the port draws ellipses as quads")
    if primitive == "points" and not sizes[0] <= params.min_width <= params.max_width <= sizes[1]:
        found = f"min_width = {params.min_width}, max_width = {params.max_width}"
        raise ValueError(f"{found}: this driver's point sprites allow {sizes[0]:g} to {sizes[1]:g}")
