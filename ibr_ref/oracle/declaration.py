"""What a port says of its device: a profile, single numbers, or both.

    "vulkan"    "gl,subpixel_bits=4"    "subpixel_bits=4,filter_result=unorm8"    "device.json"

A number replaces what the profile has: a device that rasterizes with 4 bits is `gl` with one number changed. Each number is
one that an API can be asked for, or that its standard gives a range of.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

from ibr_ref.io.files import contents, naming
from ibr_ref.oracle.accept.coverage import RASTER
from ibr_ref.oracle.device import PROFILES, Device
from ibr_ref.scene import checks

LARGEST_FILE = 2**16
FILTER_BYTES = 1.0 / 255.0
"""Of a filter that rounds to bytes: two lerps, one after the other, each to the nearest."""
DEPTH_STEPS = {"float32": 0.0, "unorm24": 2.0**-24, "unorm16": 2.0**-16}
"""Of depth buffers, by their formats."""


class Between(NamedTuple):
    """Any number from the one to the other, whole or not."""

    least: float
    most: float


class Number(NamedTuple):
    """Something that can be declared."""

    allowed: range | Between | tuple[str, ...]
    meaning: str
    """And whom to ask for it."""
    change: Callable[[Device, Any], dict[str, Any]]
    """The device's fields that it changes."""


def _subpixels(device: Device, bits: int) -> dict[str, Any]:
    """A splat's border moves by steps of the raster, and its centre is snapped to another raster than the reference's."""
    if bits == device.subpixel_bits:
        return {"subpixel_bits": bits}
    scaled, apart = device.splat_border * 2.0 ** (device.subpixel_bits - bits), 0.5 * (2.0**-bits + 1.0 / RASTER)
    # A step of a coarser raster holds the reference's rounding, one of a finer raster does not.
    return {"subpixel_bits": bits, "splat_border": max(scaled, apart) if 2.0**bits < RASTER else scaled + apart}


def _power(device: Device, ulps: float) -> dict[str, Any]:
    return {"logarithm": 2.0 * ulps, "exponential": 2.0 * ulps}


ULPS = Between(0.5, 64.0)
"""Units in the last place: 0.5 is correctly rounded. The arithmetic's own fields are in halves of them."""

ARITHMETIC: dict[str, Number] = {
    "operation_ulps": Number(
        ULPS,
        "ULP of a sum, a difference or a product, 0.5: correctly rounded, as Vulkan and WGSL want it; Direct3D 11: 1",
        lambda device, ulps: {"operation": 2.0 * ulps},
    ),
    "quotient_ulps": Number(
        ULPS,
        "ULP of a quotient; Vulkan and WGSL: 2.5, Direct3D 11: 1",
        lambda device, ulps: {"quotient": 2.0 * ulps},
    ),
    "root_ulps": Number(
        ULPS,
        "ULP of a square root; Vulkan and WGSL: 1 / inversesqrt, 4.5, Direct3D 11: 1",
        lambda device, ulps: {"root": 2.0 * ulps},
    ),
    "power_ulps": Number(
        ULPS,
        "ULP of log2 x (of 1 where |log2 x| < 1) and of exp2 x (times 1 + |x|), of which pow is made; Vulkan and WGSL: 4",
        _power,
    ),
}
"""What probes measure one after the other. Denormal results may be flushed to 0 on every device."""

NUMBERS: dict[str, Number] = {
    "subpixel_bits": Number(
        range(4, 17),
        "fractional bits of window positions: GL_SUBPIXEL_BITS, VkPhysicalDeviceLimits.subPixelPrecisionBits; "
        "OpenGL ES 3.0 and WebGL 2: at least 4",
        _subpixels,
    ),
    "texel_weight_bits": Number(
        range(17),
        "fractional bits of bilinear weights, 0: floats; VkPhysicalDeviceLimits.subTexelPrecisionBits",
        lambda device, bits: {"weight_step": 2.0**-bits if bits else 0.0},
    ),
    "filter_result": Number(
        ("float", "unorm8"),
        "what a bilinear fetch from a texture of bytes gives: unorm8 where drivers filter bytes in bytes",
        lambda device, result: {"filter_step": FILTER_BYTES if result == "unorm8" else 0.0},
    ),
    "varyings": Number(
        ("snapped", "unsnapped", "either"),
        "the triangle that varyings are interpolated over: of the rasterized corners, of those before snapping, or of "
        "either where that is not known",
        lambda device, over: {"unsnapped": over != "snapped", "snapped": over != "unsnapped"},
    ),
    "clip_z": Number(
        ("zero_to_one", "minus_one_to_one"),
        "range of z / w: glClipControl",
        lambda device, over: {"minus_one": over == "minus_one_to_one"},
    ),
    "clip_border": Number(
        ("none", "allowed"),
        "whether triangles may be cut at the picture's borders: none where a guard band is known to keep them whole",
        lambda device, cut: {"clip_border": cut == "allowed"},
    ),
    "setup": Number(
        ("clipped", "whole"),
        "corners that planes are made of where the near or the far plane cuts: those of the clipped polygon, or the "
        "triangle's own, behind the eye too, as in SwiftShader",
        lambda device, over: {"whole": over == "whole"},
    ),
    "depth_format": Number(
        tuple(DEPTH_STEPS),
        "the depth buffer's",
        lambda device, name: {"depth_step": DEPTH_STEPS[name]},
    ),
    "unorm_rounding": Number(
        ("nearest", "either"),
        "of a colour that is stored as bytes: to the nearest, or to either neighbour",
        lambda device, to: {"byte": 0.5 if to == "nearest" else 1.0},
    ),
    **ARITHMETIC,
}


def _is_allowed(value: Any, allowed: range | Between | tuple[str, ...]) -> bool:
    """Whether it may be declared: a word, a whole number, or any number."""
    if isinstance(allowed, Between):
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        return number and allowed.least <= value <= allowed.most
    whole = isinstance(value, int) and not isinstance(value, bool)
    return value in allowed and whole == isinstance(allowed, range)


def _span(allowed: range | Between | tuple[str, ...]) -> str:
    """In words."""
    if isinstance(allowed, Between):
        return f"{allowed.least:g} to {allowed.most:g}"
    return f"{allowed[0]} to {allowed[-1]}" if isinstance(allowed, range) else " | ".join(allowed)


@dataclass(frozen=True)
class Declaration:
    """A profile's name, or None where any may be it, and numbers by their names in `NUMBERS`.

    Raises ValueError for others, and for values that are not allowed.
    """

    profile: str | None = None
    numbers: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.profile is not None:
            checks.choice("device", self.profile, list(PROFILES))
        for name, value in self.numbers.items():
            checks.choice("device", name, [*NUMBERS])
            allowed = NUMBERS[name].allowed
            if not _is_allowed(value, allowed):
                raise checks.reject(name, value, _span(allowed))

    def __bool__(self) -> bool:
        return self.profile is not None or bool(self.numbers)

    def device(self, profile: str) -> Device:
        """A profile with the numbers."""
        device = PROFILES[profile]
        for name, value in self.numbers.items():
            device = replace(device, **NUMBERS[name].change(device, value), numbers={**device.numbers, name: value})
        return device


ANY = Declaration()
"""Nothing was said."""


def declared(text: str) -> Declaration:
    """Of an option: a profile's name, numbers k=v, both with commas between them, or the path of a .json file of them.

    Raises OSError or ValueError, which say what is allowed.
    """
    if text.endswith(".json"):
        return _of_file(Path(text))
    names = [part.strip() for part in text.split(",")]
    profiles = [name for name in names if "=" not in name]
    if len(profiles) > 1:
        raise checks.reject("device", text, f"one profile, {' | '.join(PROFILES)}, and numbers k=v")
    pairs = [name.split("=", 1) for name in names if "=" in name]
    twice = [key for key, _ in pairs if [k for k, _ in pairs].count(key) > 1]
    if twice:
        raise checks.reject("device", f"{twice[0]} twice", "each number once")
    return Declaration(profiles[0] if profiles else None, {key: _value(key, value) for key, value in pairs})


def device_of(text: str) -> Device:
    """The device that a text with a profile in it declares."""
    declaration = declared(text)
    assert declaration.profile is not None
    return declaration.device(declaration.profile)


def _value(name: str, text: str) -> Any:
    """A number where one is allowed, else the word."""
    allowed = NUMBERS[name].allowed if name in NUMBERS else ()
    if isinstance(allowed, Between):
        return float(text) if re.fullmatch(r"[0-9]+(\.[0-9]*)?", text, re.ASCII) else text
    return int(text) if isinstance(allowed, range) and text.isascii() and text.isdigit() else text


def _of_file(path: Path) -> Declaration:
    """{"profile": "gl", "subpixel_bits": 4}."""
    data = contents(path)
    with naming(path):
        try:
            fields = json.loads(data) if len(data) <= LARGEST_FILE else None
        except (ValueError, RecursionError):
            fields = None
        if not isinstance(fields, dict):
            raise ValueError('found no JSON object, allowed: {"profile": "gl", "subpixel_bits": 4}, say')
        return of_fields(fields)


def of_fields(fields: Mapping[str, Any]) -> Declaration:
    """Of `port.json` or a device's file."""
    return Declaration(fields.get("profile"), {key: value for key, value in fields.items() if key != "profile"})
