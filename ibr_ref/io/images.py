"""Images: PNG and JPEG, and EXR to write. Values are linear, stored as they are: no sRGB transfer in either direction."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.io import exr, jpeg, png
from ibr_ref.io.files import contents, naming
from ibr_ref.io.orientation import orientation, upright
from ibr_ref.io.outputs import atomic, check_writable, is_stream
from ibr_ref.scene.checks import named, one_line

_CODECS = (png, jpeg)
_FORMATS = {".png": ".png", ".jpg": ".jpg", ".jpeg": ".jpg", ".exr": ".exr"}
_OPTIONS: dict[str, dict[str, int]] = {".png": {}, ".jpg": {"quality": 95, "subsampling": 0}}
_MAX_JPEG_SIDE = 65535


def read_image(path: str | PathLike[str], exif: bool = True) -> NDArray[np.float64]:
    """Read a PNG or JPEG image, told apart by content: row 0 on top, values k / 255 or, with 16 bits, k / 65535.

    exif: turn it as its Exif tag Orientation says, and as viewers show it; False: the rows as they are stored.

    Returns (H, W) for grey (1, 2, 4 bits and 16 too), (H, W, 2) for grey + alpha, (H, W, 3) for RGB, (H, W, 4) for
    RGB + alpha (not premultiplied); palettes come out as RGB, with alpha if they have transparent entries.

    Raises OSError or ValueError, in one line that starts with the path, for what cannot be read, is not such an image,
    is not all there, or has no pixels or more than 2^28 (the header is asked before anything is decoded).
    """
    data = contents(path)
    with naming(path):
        return decoded(data, exif)


def decoded(data: bytes, exif: bool = True) -> NDArray[np.float64]:
    """What `read_image` returns of a file's bytes. Raises ValueError without the path."""
    for codec in _CODECS:
        if data.startswith(codec.SIGNATURE):
            image = codec.decode(data)
            return upright(image, orientation(codec.exif(data))) if exif else image
    raise ValueError(f"found a file that starts with {data[:8]!r}, allowed: a PNG or JPEG image")


def is_picture(data: bytes) -> bool:
    """Whether a file starts as a PNG or JPEG image."""
    return any(data.startswith(codec.SIGNATURE) for codec in _CODECS)


def white(data: bytes) -> float:
    """The stored number of white, 2^bits - 1, of a file that `decoded` accepts."""
    return 2.0 ** png.bits(data) - 1.0 if data.startswith(png.SIGNATURE) else 255.0


def write_image(path: str | PathLike[str], image: ArrayLike, bits: int = 8) -> None:
    """Write (H, W) grey or (H, W, 3) RGB.

    The name's ending gives the format: .png, with `bits` 8 or 16, .jpg / .jpeg (8 bits, quality 95, chroma at full
    resolution), both clamped to [0, 1], as floor(c (2^bits - 1) + 0.5); or .exr, 32-bit floats as they are, which needs the
    extra `ibr_ref[io]`. The file is written beside its place and then renamed; a link is followed, a pipe or a character
    device (as a PNG if its name has no ending) written to.

    Raises OSError or ValueError, with the path, for other endings, folders that cannot be written, other shapes, values
    that are not floats (or bools), and NaN.
    """
    kind = _kind(path, bits)
    values = _checked(path, image)
    samples = values if kind == ".exr" else _quantized(values, bits)
    if kind == ".jpg" and max(samples.shape) > _MAX_JPEG_SIDE:
        raise ValueError(
            f"{named(path)}: found an image of shape {samples.shape}, allowed in JPEG: {_MAX_JPEG_SIDE} each way"
        )
    data = _encoded(samples, kind)
    with atomic(path) as file:
        file.write(data)


def png_bytes(image: ArrayLike) -> bytes:
    """What `write_image` would write into a .png, in 8 bits. Raises ValueError as it does."""
    return _encoded(_quantized(_checked("image", image), 8), ".png")


def check_image_writable(path: str | PathLike[str], bits: int = 8) -> None:
    """Raise what `write_image` would for this name, before long work; nothing is written."""
    _kind(path, bits)
    check_writable(path)


def _kind(path: str | PathLike[str], bits: int) -> str:
    ending = Path(path).suffix
    if not ending and is_stream(path):
        return ".png"
    if ending.lower() not in _FORMATS:
        raise ValueError(f"{named(path)}: found the ending {one_line(repr(ending))}, allowed: {', '.join(_FORMATS)}")
    kind = _FORMATS[ending.lower()]
    if bits != 8 and (bits, kind) != (16, ".png"):
        raise ValueError(f"{named(path)}: found bits = {one_line(repr(bits))}, allowed: 8, or 16 in PNG")
    if kind == ".exr":
        with naming(path):
            exr.check_installed()
    return kind


def _checked(path: str | PathLike[str], image: ArrayLike) -> NDArray[Any]:
    """The image as an array of floats or bools."""
    values = np.asarray(image)
    if values.ndim not in (2, 3) or (values.ndim == 3 and values.shape[2] != 3) or not values.size:
        raise ValueError(
            f"{named(path)}: found an image of shape {values.shape}, allowed: (H, W) or (H, W, 3), not empty"
        )
    if values.dtype.kind not in "fb":
        # 0 to 255, most likely: clamped to [0, 1], it would be white all over.
        raise ValueError(f"{named(path)}: found an image of {values.dtype}, allowed: floats in [0, 1]")
    if np.isnan(values).any():
        raise ValueError(f"{named(path)}: found NaN at {np.argwhere(np.isnan(values))[0].tolist()}, allowed: numbers")
    return values


def _quantized(values: NDArray[Any], bits: int) -> NDArray[np.unsignedinteger]:
    """Conventions, Numbers: floor(255 c + 0.5) after clamping."""
    levels = float(2**bits - 1)
    steps = np.floor(np.clip(values.astype(np.float64), 0.0, 1.0) * levels + 0.5)
    return steps.astype(np.uint8 if bits == 8 else np.uint16)


def _encoded(samples: NDArray[Any], kind: str) -> bytes:
    if kind == ".exr":
        return exr.encode(samples)
    if samples.dtype == np.uint16:
        return png.encode_16(samples)
    import imageio.v3 as imageio  # here, so that importing ibr_ref.io stays cheap

    options: dict[str, Any] = _OPTIONS[kind]
    encoded: bytes = imageio.imwrite("<bytes>", samples, extension=kind, plugin="pillow", **options)
    return encoded
