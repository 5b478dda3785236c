"""What the APIs leave undefined, where the methods come near it, and why no case depends on it.

A port may get anything there, and be right. So the cases' scenes keep clear of it: `tests/oracle/test_undefined.py` watches
every operation of every case; and a `Case` whose light has the exponent 0 is refused.
"""

from __future__ import annotations

from typing import NamedTuple


class Undefined(NamedTuple):
    """An operation without a defined result."""

    operation: str
    clause: str
    """Where an API says so."""
    where: str
    """Where the methods come near it, and what keeps them clear."""


_GLSL = "GLSL 4.60, 8"
_SPIRV = "SPIR-V, GLSL.std.450"

UNDEFINED = (
    Undefined(
        "pow(x, y) where x < 0, or x = 0 and y <= 0; log2(x) where x <= 0",
        f"{_GLSL}.2; {_SPIRV}: Pow; HLSL: pow(0, 0) may be NaN; WGSL: pow is exp2(y * log2(x))",
        "Highlights, max(0, r.v)^e: the base is clamped, and e is at least 1 in every case.",
    ),
    Undefined(
        "normalize(0), and what is divided by a length of 0",
        f"{_GLSL}.5; {_SPIRV}: Normalize; WGSL: x / length(x)",
        "Lines of sight and to the light: no eye and no lamp on a surface. Mapped normals: no texels that cancel. Walls: "
        "where the gradient is 0 the method says what counts instead. Triangles: all have an area. Codes (0, 0, 0) off the "
        "mask are never lit with.",
    ),
    Undefined(
        "x / 0, inversesqrt(0), sqrt(x) where x < 0",
        f"{_GLSL}.1 and 5.9: the result is undefined; Vulkan 1.3: infinity or NaN where the device has them",
        "v_h, the way to a wall of the volume, q_w, clip w, the law's denominator, the cells of the nine maps: never "
        "exactly 0 in a case.",
    ),
    Undefined(
        "min, max and clamp of NaN; clamp where the upper end lies below the lower one",
        f"{_GLSL}.3; {_SPIRV}: FMin, FMax, FClamp; WGSL: an indeterminate value",
        "Nothing that is used is NaN: no operation of a case makes one of numbers. What is discarded or dropped is NaN only "
        "where it is handed in.",
    ),
    Undefined(
        "int(x) and uint(x) of a float out of range, uint(x) where x < 0, NaN as an integer",
        "GLSL 4.60, 5.4.1; SPIR-V: OpConvertFToS; C: 6.3.1.4",
        "Texels, lattice indices, subpixels and bytes: all lie within 2^31. int(x) truncates: indices are floor(x), which "
        "differs below 0, where fetches on a map's border and repeated maps are.",
    ),
    Undefined(
        "a % b of negative integers",
        "GLSL 4.60, 5.9",
        "Repeated maps and facades are fetched at negative coordinates: wrap by floor, or by the sampler.",
    ),
    Undefined(
        "texelFetch out of range, arrays out of bounds",
        "GLSL 4.60, 8.9.2 and 5.7; OpenGL 4.6, robust access",
        "Clamped or repeated by the conventions before the fetch; off a shadow map nothing is read.",
    ),
    Undefined(
        "x << y where y < 0 or y >= 32",
        "GLSL 4.60, 5.9; WGSL, bit expressions",
        "k = i 2^M, and N 2^M is at most 2^24.",
    ),
    Undefined(
        "atan(0, 0), asin and acos beyond [-1, 1]",
        f"{_GLSL}.1; {_SPIRV}: Atan2, Asin, Acos",
        "No method has them: angles of cameras come as matrices.",
    ),
    Undefined(
        "pack and float conversions beyond a format's range",
        "GLSL 4.60, 8.4; OpenGL 4.6, 2.3.4",
        "Colours are clamped to [0, 1] before they become bytes, depths lie in it.",
    ),
    Undefined(
        "derivatives and implicit levels of detail in diverging control flow",
        f"{_GLSL}.9 and 8.14.1; WGSL: uniformity",
        "No map has a second level: fetch at level 0 explicitly within loops and branches.",
    ),
)
"""With the clause that says so; the list that the cases are checked against."""
