"""A headless OpenGL 4.5 core context and the few calls that the ports need beyond moderngl.

The context is a surfaceless EGL one (Mesa's llvmpipe where there is no GPU). moderngl has no call for `glClipControl`, for
integer clears and for a 32-bit float depth buffer: those entry points are fetched from EGL by name.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

from ibr_ref.ports.frame import Frame

__all__ = ["Device", "Frame", "Target", "create_device", "create_target", "frame_seconds", "source", "upload"]

GL_COLOR = 0x1800
GL_DEPTH = 0x1801
GL_DEPTH_ATTACHMENT = 0x8D00
GL_DEPTH_COMPONENT = 0x1902
GL_DEPTH_COMPONENT32F = 0x8CAC
GL_FLOAT = 0x1406
GL_LOWER_LEFT = 0x8CA1
GL_TEXTURE_2D = 0x0DE1
GL_ZERO_TO_ONE = 0x935F

_UINT, _INT, _SIZE, _PTR = ctypes.c_uint, ctypes.c_int, ctypes.c_int, ctypes.c_void_p
_SIGNATURES: dict[str, tuple[type, ...]] = {
    "glClipControl": (_UINT, _UINT),
    "glCreateTextures": (_UINT, _SIZE, _PTR),
    "glTextureStorage2D": (_UINT, _SIZE, _UINT, _SIZE, _SIZE),
    "glDeleteTextures": (_SIZE, _PTR),
    "glNamedFramebufferTexture": (_UINT, _UINT, _UINT, _INT),
    "glClearNamedFramebufferfv": (_UINT, _UINT, _INT, _PTR),
    "glClearNamedFramebufferiv": (_UINT, _UINT, _INT, _PTR),
    "glGetTextureImage": (_UINT, _INT, _UINT, _UINT, _SIZE, _PTR),
}


class Entry:
    """OpenGL entry points by name, as ctypes functions; a name that the driver lacks is None."""

    def __init__(self) -> None:
        egl = ctypes.CDLL("libEGL.so.1")
        egl.eglGetProcAddress.restype = ctypes.c_void_p
        egl.eglGetProcAddress.argtypes = [ctypes.c_char_p]
        for name, arguments in _SIGNATURES.items():
            address = egl.eglGetProcAddress(name.encode())
            setattr(self, name, ctypes.CFUNCTYPE(None, *arguments)(address) if address else None)

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...


@dataclass
class Device:
    """A context of its own, and what it turned out to be."""

    ctx: moderngl.Context
    entry: Entry
    zero_to_one: bool
    """True: clip z is cut to 0 ≤ z ≤ w as in the reference; False: a vertex shader has to send 2z − w."""

    @property
    def renderer(self) -> str:
        """GL_RENDERER and GL_VERSION in one line."""
        return f"{self.ctx.info['GL_RENDERER']}, {self.ctx.info['GL_VERSION']}"

    def use(self) -> None:
        """Make its context current: another one of this process may be, such as that of WebGPU on OpenGL."""
        self.ctx.__enter__()


def source(name: str) -> str:
    """The GLSL of a file beside this one, without `#version` and #defines."""
    return (Path(__file__).parent / name).read_text(encoding="utf-8")


def create_device(*, clip_control: bool = True) -> Device:
    """A new headless context, with the clip volume of the reference where the driver has `glClipControl`."""
    ctx = moderngl.create_context(standalone=True, backend="egl", require=450, libegl="libEGL.so.1", libgl="libGL.so.1")
    entry = Entry()
    zero_to_one = clip_control and entry.glClipControl is not None
    if zero_to_one:
        entry.glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE)
    return Device(ctx=ctx, entry=entry, zero_to_one=zero_to_one)


def upload(
    device: Device, image: np.ndarray, *, dtype: str = "f4", wrap: str = "clamp", filtered: bool = True
) -> moderngl.Texture:
    """A texture of `image` (rows, columns[, channels]) in memory order, so that row 0 is v = 0.

    `dtype` is moderngl's: "f4" keeps 32-bit floats; "f1" stores floor(255 c + 0.5) as 8-bit unorm. Three channels are padded
    to four. `wrap` is "clamp" (to the edge) or "repeat". There is no mip chain.
    """
    device.use()
    image = np.asarray(image, dtype=np.float64)
    channels = 1 if image.ndim == 2 else image.shape[2]
    if channels == 3:
        image = np.concatenate([image, np.ones_like(image[..., :1])], axis=2)
        channels = 4
    data = np.floor(255.0 * image + 0.5).astype(np.uint8) if dtype == "f1" else image.astype(np.float32)
    texture = device.ctx.texture((image.shape[1], image.shape[0]), channels, data.tobytes(), alignment=1, dtype=dtype)
    kind = moderngl.LINEAR if filtered else moderngl.NEAREST
    texture.filter = (kind, kind)
    texture.repeat_x = texture.repeat_y = wrap == "repeat"
    return texture


def upload_volume(device: Device, image: np.ndarray, *, wrap: str = "clamp") -> moderngl.Texture3D:
    """A filtered texture of three dimensions, (layers, rows, columns), of 32-bit floats; clamped between the layers."""
    device.use()
    layers, rows, columns = image.shape
    texture = device.ctx.texture3d(
        (columns, rows, layers), 1, image.astype(np.float32).tobytes(), alignment=1, dtype="f4"
    )
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = wrap == "repeat"
    texture.repeat_z = False
    return texture


@dataclass
class Target:
    """A frame buffer: named colour attachments and one 32-bit float depth texture."""

    device: Device
    fbo: moderngl.Framebuffer
    textures: dict[str, moderngl.Texture]
    depth_id: int
    clears: dict[str, tuple[float, ...]] = field(default_factory=dict)

    def begin(self) -> None:
        """Bind, and clear every attachment to its own value, depth to 1."""
        self.device.use()
        self.fbo.use()
        for index, (name, texture) in enumerate(self.textures.items()):
            values = tuple(self.clears.get(name, (0.0,))) * 4
            if texture.dtype.startswith("i"):
                ints = (ctypes.c_int * 4)(*(int(value) for value in values[:4]))
                self.device.entry.glClearNamedFramebufferiv(self.fbo.glo, GL_COLOR, index, ints)
            else:
                floats = (ctypes.c_float * 4)(*values[:4])
                self.device.entry.glClearNamedFramebufferfv(self.fbo.glo, GL_COLOR, index, floats)
        self.device.entry.glClearNamedFramebufferfv(self.fbo.glo, GL_DEPTH, 0, (ctypes.c_float * 1)(1.0))

    def read(self, name: str) -> np.ndarray:
        """(H, W, channels) of one attachment; row 0 is the first row in memory: the top, as the ports negate clip y."""
        self.device.use()
        texture = self.textures[name]
        numbers = {"f1": np.uint8, "f4": np.float32, "i4": np.int32}[texture.dtype]
        array = np.frombuffer(texture.read(alignment=1), dtype=numbers)
        return array.reshape(texture.height, texture.width, texture.components).copy()

    def read_depth(self) -> np.ndarray:
        """(H, W) float32 window depth."""
        self.device.use()
        depth = np.empty((self.fbo.height, self.fbo.width), dtype=np.float32)
        self.device.entry.glGetTextureImage(
            self.depth_id, 0, GL_DEPTH_COMPONENT, GL_FLOAT, depth.nbytes, depth.ctypes.data
        )
        return depth

    def release(self) -> None:
        """Give the attachments back to the driver."""
        self.device.use()
        self.fbo.release()
        for texture in self.textures.values():
            texture.release()
        self.device.entry.glDeleteTextures(1, (ctypes.c_uint * 1)(self.depth_id))


def create_target(device: Device, width: int, height: int, attachments: Mapping[str, tuple[int, str]]) -> Target:
    """A target whose colour attachments are `name: (channels, moderngl dtype)` in the order of the shader's locations."""
    device.use()
    textures = {
        name: device.ctx.texture((width, height), channels, dtype=dtype)
        for name, (channels, dtype) in attachments.items()
    }
    fbo = device.ctx.framebuffer(color_attachments=list(textures.values()))
    depth = (ctypes.c_uint * 1)()
    device.entry.glCreateTextures(GL_TEXTURE_2D, 1, depth)
    device.entry.glTextureStorage2D(depth[0], 1, GL_DEPTH_COMPONENT32F, width, height)
    device.entry.glNamedFramebufferTexture(fbo.glo, GL_DEPTH_ATTACHMENT, depth[0], 0)
    fbo.depth_mask = True
    return Target(device=device, fbo=fbo, textures=textures, depth_id=int(depth[0]))


def frame_seconds(device: Device, draw: Callable[[], object]) -> float:
    """Seconds of one frame: what `draw` submits, up to the return of glFinish. Nothing is read back."""
    device.ctx.finish()
    start = time.perf_counter()
    draw()
    device.ctx.finish()
    return time.perf_counter() - start
