"""Devices: what an API's specification lets a correct port do differently, each number with the clause that grants it.

A port that one of `PROFILES` explains is right. Their ranks say which of two counts as the tighter one. Errors are relative,
in units of 2^-24 (half a unit in the last place of a float32, the error of one correct rounding).

A further profile is a call of `_device` here: options, help, READMEs and trials know it then.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Device:
    """The freedom of one profile. Products may be fused into sums, and sums taken in any order, under every profile."""

    name: str
    rank: int
    """The lower, the tighter: of the profiles that explain a port the verdict names the one of the lowest rank."""
    likely: bool
    """Explains most right ports that have stages: it is tried before the loosest."""
    operation: float
    """Relative error of +, - and *, in units of 2^-24."""
    quotient: float
    """Relative error of a quotient, in units of 2^-24."""
    root: float
    """Relative error of a square root, in units of 2^-24."""
    logarithm: float
    """Error of log2 x, in units of 2^-24: absolute where |log2 x| < 1, relative elsewhere. A power may be
    exp2(e log2 x)."""
    exponential: float
    """Relative error of exp2 x, in units of (1 + |x|) 2^-24."""
    weight_step: float
    """Steps of bilinear weights, in [0, 1]; a weight may be off by less than one. 0: weights are floats."""
    filter_step: float
    """How far a bilinear fetch from a texture of bytes may be from what its texels and weights give. 0: it is computed in
    floats."""
    subpixel_bits: int
    """Fractional bits of window positions."""
    subpixel_any: bool
    """A position may go to either neighbour on the raster; else to the nearest, ties to even, as the reference's."""
    unsnapped: bool
    """Varyings may be interpolated over the triangle of the unsnapped corners."""
    snapped: bool
    """They may be interpolated over that of the snapped ones."""
    splat_border: float
    """How far a splat's border may lie from centre +- width / 2, the centre snapped as the reference's, in pixels."""
    minus_one: bool
    """Clip z may run from -w to w, by a projection matrix of its own, and window depth be (z / w + 1) / 2."""
    clip_border: bool
    """Triangles may be cut at the picture's borders, -w <= x, y <= w, and varyings be set up over any pieces."""
    whole: bool
    """Triangles that the near or the far plane cuts may be set up from their own corners, behind the eye too."""
    depth_step: float
    """Steps of the depth buffer. 0: float32."""
    byte: float
    """How far a stored byte may be from 255 c, in steps: 0.5 is the nearest."""
    sources: dict[str, str] = field(default_factory=dict)
    """For each number the clause that grants it."""
    numbers: dict[str, int | float | str] = field(default_factory=dict)
    """What was declared, or found necessary, beside the profile: `declaration.NUMBERS`."""

    @property
    def words(self) -> str:
        """The profile, and what it has beside it, as it is declared."""
        return spelled(self.name, self.numbers)

    @property
    def snap(self) -> float:
        """How far a snapped position may lie from where the reference's lies, in pixels, besides its own rounding."""
        return 2.0**-self.subpixel_bits if self.subpixel_any else 0.0

    @property
    def wrapping(self) -> float:
        """How much more than a shader's arithmetic a texture unit may round coordinates that it repeats, in units of 2^-24.

        What is declared, and measured, is the shader's: units wrap in fixed point, and are as the profile grants.
        """
        return max(0.0, PROFILES[self.name].operation - self.operation)

    @property
    def varying_step(self) -> float:
        """How far a corner that varyings are interpolated over may be snapped from where it is, in pixels."""
        return 2.0**-self.subpixel_bits if self.snapped else 0.0


def _text(value: float | str) -> str:
    """Whole numbers without a point."""
    return f"{value:g}" if isinstance(value, float) else str(value)


def spelled(profile: str | None, numbers: Mapping[str, int | float | str]) -> str:
    """As it is declared: "gl,subpixel_bits=4", or numbers alone."""
    return ",".join([*([profile] if profile else []), *(f"{name}={_text(value)}" for name, value in numbers.items())])


_DEVICES: list[Device] = []


def _device(name: str, *, rank: int, likely: bool = False, **granted: tuple[float, str]) -> Device:
    """A profile. granted: for each field its number, and the clause that grants it."""
    numbers: dict[str, Any] = {key: number for key, (number, _) in granted.items()}
    sources = {key: source for key, (_, source) in granted.items()}
    device = Device(name=name, rank=rank, likely=likely, sources=sources, **numbers)
    _DEVICES.append(device)
    return device


_OPENGL = "OpenGL 4.6, Floating-Point Computation: accurate to about 1 part in 10^5 (GLSL 4.60 is tighter)"
_VULKAN = 'Vulkan 1.3, appendix "Precision and Operation of SPIR-V Instructions"'
_WGSL = "WGSL, section 15.7.4 (accuracy of concrete floating point expressions)"
_D3D = "Direct3D 11.3 functional specification"
_CENTRE = "the unsnapped centre lies up to half a step from the snapped one"
_HOMOGENEOUS = (
    "homogeneous rasterizers clip nothing (Olano and Greer 1997), and SwiftShader, which is conformant, does it"
)

IEEE32 = _device(
    "ieee32",
    rank=10,
    likely=True,
    operation=(1.0, "IEEE 754-2019, 4.3: correctly rounded"),
    quotient=(1.0, "IEEE 754-2019, 5.4.1: division is correctly rounded"),
    root=(1.0, "IEEE 754-2019, 5.4.1: squareRoot is correctly rounded"),
    logarithm=(1.0, "IEEE 754-2019, 9.2: log2 is correctly rounded"),
    exponential=(1.0, "IEEE 754-2019, 9.2: exp2 is correctly rounded"),
    weight_step=(0.0, "a filter written out in float32 arithmetic"),
    filter_step=(0.0, "a filter written out in float32 arithmetic"),
    subpixel_bits=(8, "the conventions of this reference: 1/256 pixel"),
    subpixel_any=(False, "the conventions of this reference: nearest, ties to even"),
    unsnapped=(False, "the conventions of this reference: barycentrics of the snapped positions"),
    snapped=(True, "the conventions of this reference: barycentrics of the snapped positions"),
    splat_border=(0.0, "the conventions of this reference: only the centre is snapped, the width is not"),
    minus_one=(False, "the conventions of this reference: 0 <= z <= w"),
    clip_border=(False, "the conventions of this reference: x and y are cut far beyond the picture"),
    whole=(False, "the conventions of this reference: planes are those of the clipped polygon"),
    depth_step=(0.0, "IEEE 754-2019: a float32 depth buffer"),
    byte=(0.5, "the conventions of this reference: floor(255 c + 0.5)"),
)

D3D11 = _device(
    "d3d11",
    rank=20,
    likely=True,
    operation=(2.0, "Microsoft, Floating-point rules (Direct3D 11): +, -, * may be truncated, within 1 ULP"),
    quotient=(2.0, f"{_D3D}, floating point rules: division within 1 ULP"),
    root=(2.0, f"{_D3D}, floating point rules: square root within 1 ULP"),
    logarithm=(8.0, f"{_D3D}, log instruction: absolute error 2^-21 within [0.5, 2], relative 2^-21 beyond"),
    exponential=(8.0, f"{_D3D}, exp instruction: relative error 2^-21"),
    weight_step=(2.0**-8, f"{_D3D}, texture addressing: 8 fractional bits of filter weights"),
    filter_step=(0.0, f"{_D3D}, texture filtering arithmetic: in floats"),
    subpixel_bits=(8, f"{_D3D}, rasterizer: 16.8 fixed point window positions"),
    subpixel_any=(True, f"{_D3D}, conversion to fixed point: within 0.6 ULP of the target"),
    unsnapped=(False, f"{_D3D}, rasterizer: vertices are snapped before the triangle is set up"),
    snapped=(True, f"{_D3D}, rasterizer: vertices are snapped before the triangle is set up"),
    splat_border=(1.1 * 2.0**-8, f"{_D3D}, 3.2.4.1: a quad's corners within 0.6 steps; {_CENTRE}"),
    minus_one=(False, f"{_D3D}, clipping: 0 <= z <= w"),
    clip_border=(False, f"{_D3D}, rasterizer: a guard band around the viewport"),
    whole=(False, f"{_D3D}, clipping: attributes of new vertices are interpolated before the triangle is set up"),
    depth_step=(2.0**-24, f"{_D3D}, formats: D24_UNORM_S8_UINT"),
    byte=(0.6, f"{_D3D}, conversion of floats to UNORM: within 0.6 ULP"),
)

VULKAN = _device(
    "vulkan",
    rank=30,
    operation=(1.0, f"{_VULKAN}: OpFAdd, OpFSub, OpFMul correctly rounded"),
    quotient=(5.0, f"{_VULKAN}: OpFDiv 2.5 ULP"),
    root=(9.0 + 2.0**-18, f"{_VULKAN}: sqrt inherited from 1.0 / inversesqrt, 2 ULP and 2.5 ULP"),
    logarithm=(8.0, f"{_VULKAN}: log2 3 ULP, absolute 2^-21 within [0.5, 2]; pow inherited from exp2(y log2(x))"),
    exponential=(6.0, f"{_VULKAN}: exp2 3 + 2 |x| ULP"),
    weight_step=(2.0**-8, "Vulkan 1.3, limits: subTexelPrecisionBits, 8 on desktop implementations (at least 4)"),
    filter_step=(0.0, "Vulkan 1.3, Texel Filtering: sums of products; bytes in bytes are declared"),
    subpixel_bits=(8, "Vulkan 1.3, limits: subPixelPrecisionBits, 8 on desktop implementations (at least 4)"),
    subpixel_any=(True, "Vulkan 1.3, Rasterization: the rounding to subPixelPrecisionBits is not specified"),
    unsnapped=(False, "Vulkan 1.3, Basic Polygon Rasterization: interpolation by the areas of the rasterized polygon"),
    snapped=(True, "Vulkan 1.3, Basic Polygon Rasterization: interpolation by the areas of the rasterized polygon"),
    splat_border=(
        1.5 * 2.0**-8,
        f"Vulkan 1.3, Rasterization: a quad's corners at either neighbour on the raster; {_CENTRE}",
    ),
    minus_one=(False, "Vulkan 1.3, Primitive Clipping: 0 <= z <= w"),
    clip_border=(True, "Vulkan 1.3, Primitive Clipping: the view volume, -w <= x, y <= w"),
    whole=(True, f"Vulkan 1.3, Polygons: gives no precision of what is interpolated after clipping; {_HOMOGENEOUS}"),
    depth_step=(2.0**-24, "Vulkan 1.3, Formats: VK_FORMAT_D24_UNORM_S8_UINT, X8_D24"),
    byte=(1.0, "Vulkan 1.3, Fixed-Point Data Conversions: they may give either neighbour (the nearest is preferred)"),
)

WEBGPU = _device(
    "webgpu",
    rank=40,
    operation=(1.0, f"{_WGSL}: x + y, x - y, x * y correctly rounded"),
    quotient=(5.0, f"{_WGSL}: x / y 2.5 ULP"),
    root=(9.0 + 2.0**-18, f"{_WGSL}: sqrt inherited from 1.0 / inverseSqrt, 2 ULP and 2.5 ULP"),
    logarithm=(8.0, f"{_WGSL}: log2 3 ULP, absolute 2^-21 within [0.5, 2]; pow inherited from exp2(y * log2(x))"),
    exponential=(6.0, f"{_WGSL}: exp2 3 + 2 |x| ULP"),
    weight_step=(2.0**-8, "WebGPU leaves filtering to the API below; 8 bits on Direct3D 12, Metal and desktop Vulkan"),
    filter_step=(0.0, "WebGPU leaves filtering to the API below; bytes in bytes are declared"),
    subpixel_bits=(8, "WebGPU leaves it to the API below; 8 bits on Direct3D 12, Metal and desktop Vulkan"),
    subpixel_any=(True, "WebGPU, Rasterization: gives no rounding of positions"),
    unsnapped=(
        True,
        "WebGPU, Rasterization: interpolation by barycentric coordinates, the positions' precision not said",
    ),
    snapped=(True, "WebGPU leaves rasterization to the API below"),
    splat_border=(1.5 * 2.0**-8, f"WebGPU, Rasterization: a quad's corners as any positions; {_CENTRE}"),
    minus_one=(False, "WebGPU, Coordinate Systems: 0 <= z <= w"),
    clip_border=(True, "WebGPU, Primitive Clipping: the clip volume, -w <= x, y <= w"),
    whole=(True, f"WebGPU leaves it to the API below; {_HOMOGENEOUS}"),
    depth_step=(2.0**-24, "WebGPU, Texture Format Capabilities: depth24plus may have 24 bits unorm"),
    byte=(1.0, "WebGPU leaves conversion to the API below: either neighbour"),
)

GL = _device(
    "gl",
    rank=50,
    operation=(5.0 + 2.0**-18, f"{_OPENGL}; taken here as a rounding and 2 ULP"),
    quotient=(11.0, f"{_OPENGL}; taken here as a reciprocal and a product, each a rounding and 2 ULP"),
    root=(11.0, f"{_OPENGL}; taken here as an inverse root and a reciprocal, each a rounding and 2 ULP"),
    logarithm=(12.0, f"{_OPENGL}; taken here as Vulkan's and 2 ULP"),
    exponential=(10.0, f"{_OPENGL}; taken here as Vulkan's and 2 ULP"),
    weight_step=(
        2.0**-8,
        "OpenGL 4.6, Texture Minification, gives no precision of weights; 8 bits on desktop implementations",
    ),
    filter_step=(0.0, "OpenGL 4.6, Texture Minification: sums of products; bytes in bytes are declared"),
    subpixel_bits=(8, "OpenGL 4.6, Implementation Dependent Values: SUBPIXEL_BITS at least 4, 8 on desktops"),
    subpixel_any=(True, "OpenGL 4.6, Basic Polygon Rasterization: the rounding of window positions is not specified"),
    unsnapped=(True, "OpenGL 4.6, Basic Polygon Rasterization: by areas of the triangle, snapped or not is not said"),
    snapped=(True, "OpenGL 4.6, Basic Polygon Rasterization: by areas of the triangle, snapped or not is not said"),
    splat_border=(
        1.5 * 2.0**-8,
        f"OpenGL 4.6, Points: a sprite's size has a granularity, here 1/256; quads: {_CENTRE}",
    ),
    minus_one=(True, "OpenGL 4.6, Primitive Clipping: -w <= z <= w, the initial clip control"),
    clip_border=(True, "OpenGL 4.6, Primitive Clipping: the view volume, -w <= x, y <= w"),
    whole=(
        True,
        f"OpenGL 4.6, Basic Polygon Rasterization: no precision of what is interpolated after clipping; {_HOMOGENEOUS}",
    ),
    depth_step=(2.0**-24, "OpenGL 4.6, Coordinate Transformations: window depth may be fixed point; DEPTH_COMPONENT24"),
    byte=(1.0, "OpenGL 4.6, Conversion from Floating-Point to Normalized Fixed-Point: either neighbour"),
)

PROFILES: dict[str, Device] = {device.name: device for device in sorted(_DEVICES, key=lambda device: device.rank)}
"""By name, in the order of their ranks."""
LOOSEST = max(_DEVICES, key=lambda device: device.rank).name
"""It grants whatever any other does."""

MOST_UNDECIDED = 0.005
"""Share of a case's pixels that the profile which it is meant for may leave open."""


def profile_of(undecided: Mapping[str, float]) -> str:
    """The loosest profile that leaves no more open than `MOST_UNDECIDED`; where there is none, the one that leaves least.

    undecided: share of a case's pixels by profile.
    """
    fit = [name for name, share in undecided.items() if share <= MOST_UNDECIDED]
    return max(fit, key=lambda name: PROFILES[name].rank) if fit else min(undecided, key=lambda name: undecided[name])
