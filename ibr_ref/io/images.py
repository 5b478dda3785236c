"""Images: PNG and JPEG, and EXR to write. Values are linear, stored as they are: no sRGB transfer in either direction."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.io import exr, jpeg, png
from ibr_ref.io.extras import needed
from ibr_ref.io.files import contents, naming
from ibr_ref.io.orientation import orientation, upright
from ibr_ref.io.outputs import atomic, check_writable, is_stream
from ibr_ref.io.posters import write_poster
from ibr_ref.io.samples import checked, quantized
from ibr_ref.scene.checks import named, one_line

_CODECS = (png, jpeg)
_FORMATS = {".png": ".png", ".jpg": ".jpg", ".jpeg": ".jpg", ".exr": ".exr", ".tif": ".tif", ".tiff": ".tif"}
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

    The name's ending gives the format: .png and .tif, with `bits` 8 or 16, .jpg / .jpeg (8 bits, quality 95, chroma at full
    resolution), all clamped to [0, 1], as floor(c (2^bits - 1) + 0.5); or .exr, 32-bit floats as they are. EXR and TIFF
    (RGB alone, tiled, as `write_poster` has it) need the extra `ibr_ref[io]`. The file is written beside its place and then
    renamed; a link is followed, a pipe or a character device (as a PNG if its name has no ending) written to.

    Raises OSError or ValueError, with the path, for other endings, folders that cannot be written, other shapes, values
    that are not floats (or bools), and NaN.
    """
    kind = _kind(path, bits)
    values = checked(path, image)
    if kind == ".tif":
        if values.ndim != 3:
            raise ValueError(f"{named(path)}: found an image of shape {values.shape}, allowed in TIFF: (H, W, 3)")
        write_poster(path, lambda rows: values[slice(*rows)], values.shape[1], values.shape[0], bits)
        return
    samples = values if kind == ".exr" else quantized(values, bits)
    if kind == ".jpg" and max(samples.shape) > _MAX_JPEG_SIDE:
        raise ValueError(
            f"{named(path)}: found an image of shape {samples.shape}, allowed in JPEG: {_MAX_JPEG_SIDE} each way"
        )
    data = _encoded(samples, kind)
    with atomic(path) as file:
        file.write(data)


def png_bytes(image: ArrayLike) -> bytes:
    """What `write_image` would write into a .png, in 8 bits. Raises ValueError as it does."""
    return _encoded(quantized(checked("image", image), 8), ".png")


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
    if bits != 8 and (bits != 16 or kind not in (".png", ".tif")):
        raise ValueError(f"{named(path)}: found bits = {one_line(repr(bits))}, allowed: 8, or 16 in PNG and TIFF")
    with naming(path):
        if kind == ".exr":
            exr.check_installed()
        elif kind == ".tif":
            needed("tifffile", "TIFF files")
    return kind


def _encoded(samples: NDArray[Any], kind: str) -> bytes:
    if kind == ".exr":
        return exr.encode(samples)
    if samples.dtype == np.uint16:
        return png.encode_16(samples)
    import imageio.v3 as imageio  # here, so that importing ibr_ref.io stays cheap

    options: dict[str, Any] = _OPTIONS[kind]
    encoded: bytes = imageio.imwrite("<bytes>", samples, extension=kind, plugin="pillow", **options)
    return encoded
