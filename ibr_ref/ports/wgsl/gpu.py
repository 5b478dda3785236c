"""A WebGPU device without a window, and the few calls that the ports need.

Nothing beyond what every WebGPU implementation has is asked for: no filtering of 32-bit floats (shaders mix the texels
themselves), no drawing into them (shaders hand on their bits, as unsigned numbers: OpenGL ES draws into those), and no more
than 32 bytes of colour a pixel and pass (a port with more stages draws several times).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import wgpu

TARGET = wgpu.TextureUsage.RENDER_ATTACHMENT | wgpu.TextureUsage.COPY_SRC | wgpu.TextureUsage.TEXTURE_BINDING
KINDS: dict[str, tuple[type[np.generic], int]] = {
    "r32float": (np.float32, 1),
    "r32sint": (np.int32, 1),
    "r32uint": (np.uint32, 1),
    "r8unorm": (np.uint8, 1),
    "rgba32float": (np.float32, 4),
    "rgba32sint": (np.int32, 4),
    "rgba32uint": (np.uint32, 4),
    "depth32float": (np.float32, 1),
}
"""Of textures: their numbers, and how many a texel has."""
ROW = 256
"""Bytes that a row of a copy to a buffer is a multiple of."""


@dataclass
class Device:
    """An adapter and its device."""

    adapter: Any
    device: Any
    modules: dict[str, Any] = field(default_factory=dict)

    @property
    def words(self) -> str:
        """The adapter and its backend."""
        return str(self.adapter.summary)

    def module(self, code: str) -> Any:
        """A shader, compiled once."""
        if code not in self.modules:
            self.modules[code] = self.device.create_shader_module(code=code)
        return self.modules[code]


def adapters() -> list[str]:
    """What this machine has."""
    return [str(each.summary) for each in wgpu.gpu.enumerate_adapters_sync()]


def create_device(adapter: str | None = None) -> Device:
    """The first adapter whose summary has all the words; None: the first. Raises ValueError with what is there."""
    found = wgpu.gpu.enumerate_adapters_sync()
    wanted = (adapter or "").lower().split()
    fit = [each for each in found if all(word in each.summary.lower() for word in wanted)]
    if not fit:
        there = ", ".join(repr(str(each.summary)) for each in found) or "none is there"
        raise ValueError(f"adapter: found {adapter!r}, allowed: words of {there}")
    return Device(fit[0], fit[0].request_device_sync())


def source(*names: str) -> str:
    """The WGSL of files beside this one, one after the other."""
    return "".join((Path(__file__).parent / name).read_text(encoding="utf-8") for name in names)


def constants(values: Mapping[str, object]) -> str:
    """Lines in front of a shader: WGSL has no #define, and code behind a constant that is false costs nothing."""
    lines = []
    for name, value in values.items():
        kind = "bool" if isinstance(value, bool) else "i32" if isinstance(value, int) else "f32"
        text = str(value).lower() if isinstance(value, bool) else repr(value)
        lines.append(f"const {name}: {kind} = {text};\n")
    return "".join(lines)


def upload(device: Device, image: np.ndarray, kind: str = "") -> Any:
    """A texture of (rows, columns[, channels]), row 0 first; floats, three channels padded to four, or of `kind`."""
    array = np.asarray(image)
    if not kind:
        kind = "r32float" if array.ndim == 2 else "rgba32float"
    numbers, channels = KINDS[kind]
    texels = np.zeros((*array.shape[:2], channels), numbers)
    texels[..., : 1 if array.ndim == 2 else array.shape[2]] = array[..., None] if array.ndim == 2 else array
    size = (array.shape[1], array.shape[0], 1)
    usage = wgpu.TextureUsage.TEXTURE_BINDING | wgpu.TextureUsage.COPY_DST
    texture = device.device.create_texture(size=size, format=kind, usage=usage)
    layout = {"bytes_per_row": texels.strides[0], "rows_per_image": size[1]}
    device.device.queue.write_texture({"texture": texture}, np.ascontiguousarray(texels), layout, size)
    return texture


def bits(floats: Sequence[float]) -> tuple[int, ...]:
    """Of 32-bit floats: what their texture is cleared to."""
    return tuple(np.asarray(floats, np.float32).view(np.uint32).tolist())


def target(device: Device, width: int, height: int, kind: str) -> Any:
    """A texture to draw into, and to fetch or copy from."""
    return device.device.create_texture(size=(width, height, 1), format=kind, usage=TARGET)


def buffer(device: Device, data: bytes, usage: Any) -> Any:
    """A buffer with that in it, padded to whole words; of 16 bytes at the least."""
    padded = data + b"\0" * max(16 - len(data), -len(data) % 4)
    return device.device.create_buffer_with_data(data=padded, usage=usage)


def read_texture(device: Device, texture: Any) -> np.ndarray:
    """(rows, columns) or (rows, columns, 4)."""
    width, height = texture.size[:2]
    numbers, channels = KINDS[texture.format]
    row = -(-width * channels * np.dtype(numbers).itemsize // ROW) * ROW
    copy = device.device.create_buffer(size=row * height, usage=wgpu.BufferUsage.COPY_DST | wgpu.BufferUsage.COPY_SRC)
    encoder = device.device.create_command_encoder()
    layout = {"buffer": copy, "bytes_per_row": row, "rows_per_image": height}
    encoder.copy_texture_to_buffer({"texture": texture}, layout, (width, height, 1))
    device.device.queue.submit([encoder.finish()])
    rows = np.frombuffer(device.device.queue.read_buffer(copy), numbers).reshape(height, -1)[:, : width * channels]
    return rows.reshape(height, width, *([channels] if channels > 1 else [])).copy()


def read_floats(device: Device, texture: Any) -> np.ndarray:
    """The floats whose bits were handed on."""
    return read_texture(device, texture).view(np.float32)


SCREEN = """
@vertex fn screen(@builtin(vertex_index) number: u32) -> @builtin(position) vec4f {
    return vec4f(select(-1.0, 3.0, number == 1u), select(-1.0, 3.0, number == 2u), 0.0, 1.0);
}
"""
"""One triangle that covers the target."""
_DEPTH = (
    SCREEN
    + """
@group(0) @binding(0) var depths: texture_2d<f32>;
@fragment fn copied(@builtin(position) at: vec4f) -> @location(0) vec4u {
    return vec4u(bitcast<u32>(textureLoad(depths, vec2i(at.xy), 0).x), 0u, 0u, 0u);
}
"""
)


def read_depth(device: Device, depth: Any) -> np.ndarray:
    """(rows, columns) float32 of a depth buffer, which OpenGL ES does not copy: drawn into numbers."""
    result = target(device, depth.width, depth.height, "r32uint")
    made = pipeline(device, _DEPTH, ("screen", "copied"), ["r32uint"], depth=False)
    screen(device, made, {0: depth}, [(result, (0, 0, 0, 0))])
    return read_floats(device, result)


def screen(
    device: Device, pipeline: Any, resources: Mapping[int, Any], colors: Sequence[tuple[Any, Sequence[float] | None]]
) -> None:
    """One triangle over all of a target."""
    encoder = device.device.create_command_encoder()
    drawing = begin(encoder, colors)
    drawing.set_pipeline(pipeline)
    if resources:
        drawing.set_bind_group(0, bind(device, pipeline, resources))
    drawing.draw(3)
    drawing.end()
    device.device.queue.submit([encoder.finish()])


def read_buffer(device: Device, source: Any, numbers: type[np.generic], width: int) -> np.ndarray:
    """(n, width)."""
    return np.frombuffer(device.device.queue.read_buffer(source), numbers).reshape(-1, width).copy()


def bind(device: Device, pipeline: Any, resources: Mapping[int, Any]) -> Any:
    """Group 0: buffers whole, textures as they are."""

    def entry(resource: Any) -> Any:
        if isinstance(resource, wgpu.GPUBuffer):
            return {"buffer": resource, "offset": 0, "size": resource.size}
        return resource.create_view() if isinstance(resource, wgpu.GPUTexture) else resource

    entries = [{"binding": number, "resource": entry(each)} for number, each in resources.items()]
    return device.device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=entries)


@dataclass(frozen=True)
class Vertices:
    """A vertex buffer: its stride in bytes, and format and offset of each location."""

    stride: int
    formats: Sequence[tuple[str, int]]
    instanced: bool = False

    def layout(self) -> dict[str, Any]:
        """As a pipeline takes it."""
        attributes = [
            {"format": form, "offset": offset, "shader_location": location}
            for location, (form, offset) in enumerate(self.formats)
        ]
        step = wgpu.VertexStepMode.instance if self.instanced else wgpu.VertexStepMode.vertex
        return {"array_stride": self.stride, "step_mode": step, "attributes": attributes}


def pipeline(
    device: Device,
    code: str,
    entries: tuple[str, str],
    kinds: Sequence[str],
    vertices: Sequence[Vertices] = (),
    *,
    depth: bool = True,
    blend: Any = None,
) -> Any:
    """Triangles, both orientations, depth test LESS where there is a depth buffer; entries: of vertex and fragment stage."""
    module = device.module(code)
    targets = [{"format": kind, **({"blend": blend} if blend else {})} for kind in kinds]
    test = {"format": "depth32float", "depth_write_enabled": True, "depth_compare": wgpu.CompareFunction.less}
    return device.device.create_render_pipeline(
        layout="auto",
        vertex={"module": module, "entry_point": entries[0], "buffers": [each.layout() for each in vertices]},
        primitive={"topology": wgpu.PrimitiveTopology.triangle_list, "cull_mode": wgpu.CullMode.none},
        depth_stencil=test if depth else None,
        multisample={"count": 1},
        fragment={"module": module, "entry_point": entries[1], "targets": targets},
    )


def begin(encoder: Any, colors: Sequence[tuple[Any, Sequence[float] | None]], depth: Any = None) -> Any:
    """A pass into textures, each cleared to its value (None: as it is); depth is cleared to 1."""
    attachments = [
        {
            "view": texture.create_view(),
            "clear_value": tuple(value) if value is not None else (0.0, 0.0, 0.0, 0.0),
            "load_op": wgpu.LoadOp.load if value is None else wgpu.LoadOp.clear,
            "store_op": wgpu.StoreOp.store,
        }
        for texture, value in colors
    ]
    deep = None if depth is None else {
        "view": depth.create_view(),
        "depth_clear_value": 1.0,
        "depth_load_op": wgpu.LoadOp.clear,
        "depth_store_op": wgpu.StoreOp.store,
    }  # fmt: skip
    return encoder.begin_render_pass(color_attachments=attachments, depth_stencil_attachment=deep)


def compute(device: Device, code: str, entry: str, resources: Mapping[int, Any], count: int) -> None:
    """Run a compute shader of 64 lanes a group over `count`."""
    made = device.device.create_compute_pipeline(
        layout="auto", compute={"module": device.module(code), "entry_point": entry}
    )
    encoder = device.device.create_command_encoder()
    run = encoder.begin_compute_pass()
    run.set_pipeline(made)
    run.set_bind_group(0, bind(device, made, resources))
    run.dispatch_workgroups(-(-count // 64), 1, 1)
    run.end()
    device.device.queue.submit([encoder.finish()])


_REMAINDER = """
@group(0) @binding(0) var<storage, read_write> numbers: array<i32>;
@compute @workgroup_size(64) fn remainder(@builtin(global_invocation_id) at: vec3u) {
    if (at.x == 0u) { numbers[2] = numbers[0] % numbers[1]; }
}
"""


def remainder(device: Device, a: int, b: int) -> int:
    """What the device makes of a % b of two i32: by WGSL truncated, with the sign of a."""
    usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_SRC
    numbers = buffer(device, np.array([a, b, 0, 0], np.int32).tobytes(), usage)
    compute(device, _REMAINDER, "remainder", {0: numbers}, 1)
    return int(read_buffer(device, numbers, np.int32, 4)[0, 2])
