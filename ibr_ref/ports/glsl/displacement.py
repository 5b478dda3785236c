"""Protruded displacement mapping on OpenGL: the same inputs as `ibr_ref.displacement.render`, in float32 GLSL.

The scene is that of an exported case, as case_folder.py reads it; nothing of `ibr_ref` is imported. Ported is
method="protruded" with all intervals, domains, faces and depths, normal map, facade map and self-shadow, and the searches
below the polygon that there are cases of. Per polygon the
host does in float64 what an application does once per object: matrices, the eye and the light in patch space, the choice of
the faces; all else happens in the shaders.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from ibr_ref.ports.displacement_arrays import below_one_another, stage_arrays
from ibr_ref.ports.glsl import gl
from ibr_ref.ports.glsl.patch_frame import PatchFrame

FAST = {"color": (4, "f1")}
STAGES = {
    "color": (4, "f4"),
    "index": (4, "i4"),
    "patch": (4, "f4"),
    "hit": (4, "f4"),
    "albedo": (4, "f4"),
    "normal": (4, "f4"),
}
BELOW = ("relief", "welsh", "mcguire", "tatarchuk", "cone", "relaxed_cone", "donnelly", "maximum_mipmap")
"""Searches below the polygon."""
MISS_DEPTH = np.float32(0.99999994)
"""What a discarded fragment writes as depth when stages are kept: behind any hit, in front of the cleared buffer."""


@dataclass
class _Draw:
    """One polygon, ready to be submitted."""

    vao: moderngl.VertexArray
    uniforms: moderngl.Buffer
    block: bytes
    textures: list[moderngl.Texture | moderngl.Texture3D]
    owned: list[Any]


@dataclass
class Prepared:
    """A scene with its textures uploaded and its programs linked: `draw` is a whole frame, as often as one likes."""

    device: gl.Device
    target: gl.Target
    draws: list[_Draw]
    stages: bool
    vertices: dict[str, np.ndarray]

    def draw(self) -> None:
        """Submit a frame: clear, then per polygon the uniforms, the textures and one indexed draw call."""
        self.target.begin()
        self.device.ctx.enable_only(moderngl.DEPTH_TEST)
        self.device.ctx.depth_func = "<"
        for draw in self.draws:
            draw.uniforms.write(draw.block)
            draw.uniforms.bind_to_uniform_block(0)
            for unit, texture in enumerate(draw.textures):
                texture.use(unit)
            draw.vao.render(moderngl.TRIANGLES)

    def seconds(self) -> float:
        """Time of one frame, from the first call to the return of glFinish, without read-back."""
        return gl.frame_seconds(self.device, self.draw)

    def read(self) -> gl.Frame:
        """The frame that was drawn last."""
        color = self.target.read("color")
        color = color[..., :3] / 255.0 if color.dtype == np.uint8 else color[..., :3].astype(np.float64)
        depth = self.target.read_depth()
        if not self.stages:
            return gl.Frame(color=color, depth=depth.astype(np.float64))
        shown = stage_arrays(*map(self.target.read, ("index", "patch", "hit", "albedo", "normal")))
        depth = np.where(shown["march.hit_index"] < 0, 1.0, depth.astype(np.float64))
        return gl.Frame(color=color, depth=depth, stages=self.vertices | shown)

    def release(self) -> None:
        """Give everything back to the driver."""
        self.target.release()
        for draw in self.draws:
            for item in draw.owned:
                item.release()


@dataclass
class _Variant:
    """Which shader: the parameters that become constants, with or without stages, filtered or packed heights."""

    params: Any
    stages: bool
    packed: bool


class Port:
    """The port on one device. Programs are kept, so that a second scene with the same parameters links nothing."""

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

    def prepare(self, scene: Any, params: Any, *, stages: bool = True, packed: bool = False) -> Prepared:
        """Upload `scene`, compile for `params`; `stages=False` is the variant that is timed: RGBA8 and depth alone.

        `packed`: the height texture holds four neighbours a texel, read by one texelFetch and mixed in the shader, instead
        of the sampler's linear filter: four times the memory, up to 15 % faster on llvmpipe.
        """
        self.device.use()
        _check(scene, params, packed)
        attachments = STAGES if stages else FAST
        target = gl.create_target(self.device, int(scene.camera.width), int(scene.camera.height), attachments)
        target.clears = {
            "color": (*map(float, scene.background), 0.0),
            "index": (-1,),
            **dict.fromkeys(("patch", "hit", "normal"), (np.nan, np.nan, np.nan, 0.0)),
            "albedo": (np.nan, np.nan, np.nan, 0.0),
        }
        draws: list[_Draw] = []
        captured: list[tuple[np.ndarray, np.ndarray]] = []
        for number, polygon in enumerate(scene.polygons):
            frame = PatchFrame.of(polygon, scene)
            faces = frame.faces("base" if params.method in BELOW else params.faces, params.interval)
            if len(faces):
                draws.append(self._polygon(frame, number, faces, _Variant(params, stages, packed)))
            if stages and len(faces):
                captured.append(self._capture(target, draws[-1], faces))
        vertices = {
            "vertex.clip": np.concatenate([clip for clip, _ in captured] or [np.zeros((0, 4), np.float32)]),
            "vertex.patch": np.concatenate([patch for _, patch in captured] or [np.zeros((0, 3), np.float32)]),
        }
        return Prepared(device=self.device, target=target, draws=draws, stages=stages, vertices=vertices)

    def _polygon(self, frame: PatchFrame, number: int, faces: np.ndarray, variant: _Variant) -> _Draw:
        """Buffers, textures and program of one polygon."""
        ctx = self.device.ctx
        search = "below" if variant.params.method in BELOW else "protruded"
        program = self._program(_defines(frame, variant, self.device.zero_to_one), search)
        vertices = ctx.buffer(faces.tobytes())
        indices = ctx.buffer(_quad_indices(len(faces)).tobytes())
        names = ("in_patch", "in_face") if variant.stages else ("in_patch",)  # what no shader reads has no location
        layout = [(vertices, "3f 1i" if variant.stages else "3f 4x", *names)]
        vao = ctx.vertex_array(program, layout, index_buffer=indices, index_element_size=4)
        block = frame.uniforms(number)
        uniforms = ctx.buffer(block)
        textures = _textures(self.device, frame.polygon, variant)
        owned = [vao, vertices, indices, uniforms, *textures]
        return _Draw(vao=vao, uniforms=uniforms, block=block, textures=textures, owned=owned)

    def _program(self, defines: str, search: str) -> moderngl.Program:
        """The linked program for these #defines, with the search of a file."""
        if defines not in self._programs:
            vertex, fragment = (defines + gl.source(f"displacement.{kind}") for kind in ("vert", "frag"))
            fragment = fragment.replace("#include SEARCH", gl.source(f"displacement_{search}.frag"))
            self._programs[defines] = self.device.ctx.program(vertex_shader=vertex, fragment_shader=fragment)
        return self._programs[defines]

    def _capture(self, target: gl.Target, draw: _Draw, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Clip (n, 4), before y is negated, and patch positions (n, 3) of the corners, as the vertex shader made them."""
        ctx = self.device.ctx
        defines = _header({"CAPTURE": 1, "ZERO_TO_ONE": 1})
        if defines not in self._programs:
            self._programs[defines] = ctx.program(
                vertex_shader=defines + gl.source("displacement.vert"), varyings=["clip", "patch_position"]
            )
        source = ctx.buffer(faces.tobytes())
        result = ctx.buffer(reserve=4 * len(faces) * 7 * 4)
        vao = ctx.vertex_array(self._programs[defines], [(source, "3f 1i", "in_patch", "in_face")])
        target.fbo.use()  # a draw call wants a complete frame buffer, even if nothing is rasterized
        draw.uniforms.bind_to_uniform_block(0)
        vao.transform(result, moderngl.POINTS, vertices=4 * len(faces))
        rows = np.frombuffer(result.read(), dtype=np.float32).reshape(-1, 7).copy()
        for item in (vao, source, result):
            item.release()
        return rows[:, :4], rows[:, 4:]


def _header(defines: dict[str, object]) -> str:
    """The lines in front of a shader's source."""
    return "#version 450 core\n" + "".join(f"#define {name} {value}\n" for name, value in defines.items())


def _defines(frame: PatchFrame, variant: _Variant, zero_to_one: bool) -> str:
    """`params` and the shape of the scene as compile-time constants."""
    params = variant.params
    below = params.method in BELOW
    defines: dict[str, object] = {
        "LINEAR_STEPS": int(params.linear_steps),
        "BINARY_STEPS": int(params.binary_steps),
        "SHADOW_STEPS": int(params.shadow_steps),
        "SHADOW_BIAS": f"float({float(params.shadow_bias)!r})",
        "STEEP_THRESHOLD": f"float({float(params.steep_threshold)!r})",
        "EXPONENT": int(frame.scene.light.exponent),
        "MIN_STEPS": int(params.min_steps),
        "MAX_STEPS": int(params.max_steps),
        "FLOOR": "-1.0" if below and params.method != "welsh" else "0.0",
    }
    flags = {
        "HAS_NORMAL_MAP": frame.polygon.normal_map is not None,
        "HAS_FACADE_MAP": frame.polygon.facade_map is not None and not below,
        "HAS_SPECULAR": frame.scene.light.specular != 0,
        "POLYGON_DEPTH": params.depth == "polygon" or params.method == "welsh",
        "PACKED_HEIGHTS": variant.packed,
        "REPEAT": frame.polygon.domain == "repeat",
        "VOLUME": params.interval == "volume",
        "STAGES": variant.stages,
        "ZERO_TO_ONE": zero_to_one,
        params.method.upper(): below,
    }
    return _header(defines | {name: 1 for name, present in flags.items() if present})


def _quad_indices(count: int) -> np.ndarray:
    """Triangles abc and acd of `count` quads."""
    return np.asarray(4 * np.arange(count)[:, None] + np.array([0, 1, 2, 0, 2, 3]), np.int32)


def _textures(device: gl.Device, polygon: Any, variant: _Variant) -> list[moderngl.Texture | moderngl.Texture3D]:
    """Height (always 32-bit float), colour, normal and facade map, what a search has besides, by texture unit.

    For the timed variant colours that are multiples of 1/255 are kept as 8-bit textures, as an application would.
    """
    unused = np.zeros((1, 1, 3))
    repeat = "repeat" if polygon.domain == "repeat" else "clamp"
    images = [polygon.color_map, polygon.normal_map, polygon.facade_map]
    if variant.packed:
        textures = [gl.upload(device, _packed(polygon.height_map), filtered=False)]
    else:
        textures = [gl.upload(device, polygon.height_map, wrap=repeat)]
    for image, wrap in zip(images, (repeat, repeat, "repeat"), strict=True):
        image = unused if image is None else np.asarray(image, float)
        eight_bit = not variant.stages and bool(np.all(np.abs(255.0 * image - np.rint(255.0 * image)) < 1e-6))
        textures.append(gl.upload(device, image, dtype="f1" if eight_bit else "f4", wrap=wrap))
    cones = getattr(polygon, "cone_map", None)
    if cones is not None:
        textures.append(gl.upload(device, cones, wrap=repeat))
    distances = getattr(polygon, "distance_map", None)
    if distances is not None:
        textures.append(gl.upload_volume(device, distances, wrap=repeat))
    levels = getattr(polygon, "quadtree", None)
    if levels is not None:
        textures.append(gl.upload(device, below_one_another(levels), filtered=False))
    return textures


def _packed(heights: np.ndarray) -> np.ndarray:
    """(H + 1, W + 1, 4): at (i, j) the texels (i − 1, j − 1), (i − 1, j), (i, j − 1), (i, j), clamped to the edge."""
    padded = np.pad(np.asarray(heights, float), 1, mode="edge")
    return np.stack([padded[:-1, :-1], padded[:-1, 1:], padded[1:, :-1], padded[1:, 1:]], axis=2)


def _check(scene: Any, params: Any, packed: bool) -> None:
    """Refuse what is not ported."""
    if params.method not in ("protruded", *BELOW):
        raise ValueError(f"method = {params.method!r}: the port allows protruded, {', '.join(BELOW)}")
    if packed and any(polygon.domain == "repeat" for polygon in scene.polygons):
        raise ValueError("domain = 'repeat': the port allows clip with packed heights")
