"""Files of depths or disparities, told apart by content."""

from __future__ import annotations

import math
import re
from io import BytesIO
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import png
from ibr_ref.io.depth_codes import depth_codes
from ibr_ref.io.files import contents, naming
from ibr_ref.io.sizes import check_size
from ibr_ref.io.values import is_exr, is_pfm, is_tiff, read_values

_NPY = b"\x93NUMPY"
_NPY_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}
_COLMAP = re.compile(rb"(\d{1,9})&(\d{1,9})&(\d{1,9})&")


def read_depth_map(path: str | PathLike[str]) -> tuple[NDArray[np.float64], bool]:
    """The numbers of a map (H, W) as they are stored, row 0 on top, and whether the file has whole numbers.

    PNG, NPY, a dense map of COLMAP, EXR, PFM or TIFF.

    Raises OSError or ValueError, in one line that starts with the path, for what cannot be read or is not all there.
    """
    data = contents(path)
    if data.startswith(png.SIGNATURE):
        return depth_codes(path)[0], True
    with naming(path):
        own = _npy if data.startswith(_NPY) else _colmap if _COLMAP.match(data[:32]) else None
        values = None if own is None else own(data)
        if values is None and not (is_exr(data) or is_pfm(data) or is_tiff(data)):
            found = f"a file that starts with {data[:8]!r}"
            raise ValueError(f"found {found}, allowed for depths: PNG, NPY, EXR, PFM, TIFF or a map of COLMAP")
    if values is None:
        values = read_values(path)
    with naming(path):
        if values.ndim == 3 and ((values == values[..., :1]) | (values != values)).all():
            values = values[..., 0]
        if values.ndim != 2 or values.dtype.kind not in "uif":
            found = f"an array {values.shape} of {values.dtype}"
            raise ValueError(
                f"found {found}, allowed for depths: (H, W), or equal channels, of whole numbers or floats"
            )
        return values.astype(np.float64), values.dtype.kind != "f"


def _npy(data: bytes) -> NDArray[np.generic]:
    """A NumPy array: no pickles, and the sizes agree before anything is allocated."""
    file = BytesIO(data)
    try:
        version = np.lib.format.read_magic(file)
        read = _NPY_HEADERS[version]
        shape, fortran, dtype = read(file)
    except Exception:  # it is a Python expression, and can be wrong in any way
        raise ValueError(f"found an NPY header {data[:60]!r}, allowed: one of version 1.0 or 2.0") from None
    if dtype.kind not in "uif" or len(shape) not in (2, 3) or min(shape) < 1 or max(shape[2:], default=1) > 4:
        raise ValueError(f"found an array {shape} of {dtype}, allowed for depths: (H, W) of whole numbers or floats")
    check_size(shape[1], shape[0])
    needed, there = math.prod(shape) * dtype.itemsize, len(data) - file.tell()
    if needed != there:
        raise ValueError(f"found {there} bytes of numbers, {needed} needed for the shape {shape} in its header")
    return np.frombuffer(data, dtype, offset=file.tell()).reshape(shape, order="F" if fortran else "C")


def _colmap(data: bytes) -> NDArray[np.generic]:
    """A dense map of COLMAP: `WIDTH&HEIGHT&CHANNELS&`, then 32-bit floats, little-endian, row after row."""
    header = _COLMAP.match(data[:32])
    assert header is not None
    width, height, channels = map(int, header.groups())
    if channels != 1:
        raise ValueError(f"found a COLMAP map of {channels} channels, allowed for depths: 1")
    check_size(width, height)
    there, needed = len(data) - header.end(), 4 * width * height
    if there != needed:
        raise ValueError(f"found {there} bytes of a COLMAP map, {needed} needed for its {width} x {height} pixels")
    return np.frombuffer(data, "<f4", offset=header.end()).reshape(height, width)
