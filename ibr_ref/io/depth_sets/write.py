"""Depth sets, written: as a transforms.json that nerfstudio reads too."""

from __future__ import annotations

import json
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.depth_sets.transforms import NAME
from ibr_ref.io.files import naming
from ibr_ref.io.images import write_image
from ibr_ref.io.outputs import atomic, check_writable, make_folder
from ibr_ref.scene import DepthImage, checks

_LAST = 65535


def write_depth_set(
    folder: str | PathLike[str], images: Sequence[DepthImage], *, depth_scale: float | None = None, bits: int = 8
) -> None:
    """Write reference images as a folder that `read_depth_set` reads: transforms.json, images/NNN.png, depth/NNN.npy.

    Colours are kept in 8 bits, or 16; masks and depths to the last bit, as float64, 0 off the mask; near, far and
    intrinsics too, poses to rounding. A skew is written under that name, which other programs do not look for.
    depth_scale: depths as 16-bit PNG instead, depth/NNN.png, in whole numbers of so many world units
    (integer_depth_scale of instant-ngp), to half a unit. nerfstudio needs --depth-unit-scale-factor 1, or that number.

    What is there under these names is replaced, transforms.json last. Raises ValueError, with the folder and the image, for
    orthographic cameras, which the file has no words for, and depths that are not 1 to 65535 units; OSError where
    nothing can be written.
    """
    folder = Path(folder)
    images = tuple(images) if isinstance(images, Sequence) else ()
    if not images or not all(isinstance(image, DepthImage) for image in images):
        raise ValueError(
            f"{checks.named(folder)}: images: found something else or none, allowed: a sequence of DepthImages"
        )
    scale = None if depth_scale is None else checks.number("depth_scale", depth_scale, above=0.0, high=1e9)
    checks.whole("bits", bits, low=8, high=16)
    ending = "npy" if scale is None else "png"
    frames = []
    for i, image in enumerate(images):
        with naming(f"{folder}: images[{i}]"):
            frames.append(_frame(image, f"images/{i:03d}.png", f"depth/{i:03d}.{ending}"))
            if scale is not None:
                _codes(image, scale)  # before anything is written
    for place in (folder, folder / "images", folder / "depth"):
        make_folder(place)
    check_writable(folder / NAME)
    for image, frame in zip(images, frames, strict=True):
        color, depth, _ = image.arrays
        write_image(folder / frame["file_path"], color, bits)
        if scale is not None:
            write_image(folder / frame["depth_file_path"], _codes(image, scale) / _LAST, bits=16)
            continue
        with atomic(folder / frame["depth_file_path"]) as file:
            np.lib.format.write_array(file, depth.astype("<f8"), version=(1, 0), allow_pickle=False)
    tree = {"camera_model": "PINHOLE", **({} if scale is None else {"integer_depth_scale": scale}), "frames": frames}
    with atomic(folder / NAME) as file:
        file.write(json.dumps(tree, indent=1).encode())


def _frame(image: DepthImage, color: str, depth: str) -> dict[str, Any]:
    camera = image.camera
    (f_x, skew, c_x), (_, f_y, c_y) = camera.intrinsics[:2].tolist()
    if not camera.perspective or min(f_x, f_y) <= 0.0:
        kind = f"intrinsics {camera.intrinsics.tolist()}" if camera.perspective else "an orthographic one"
        raise checks.reject("camera", kind, "a pinhole, focal lengths above 0")
    return {
        "file_path": color,
        "depth_file_path": depth,
        **{"fl_x": f_x, "fl_y": f_y, "cx": c_x, "cy": c_y, "w": camera.width, "h": camera.height},
        **({} if skew == 0.0 else {"skew": skew}),
        **{"near": camera.near, "far": camera.far},
        "transform_matrix": camera.world_from_view.tolist(),
    }


def _codes(image: DepthImage, scale: float) -> NDArray[np.float64]:
    """(H, W) whole numbers, 1 to 65535, and 0 off the mask."""
    _, depth, mask = image.arrays
    codes = np.rint(depth / scale)
    bad = mask & ~((codes >= 1.0) & (codes <= _LAST))
    if bad.any():
        row, column = np.argwhere(bad)[0].tolist()
        allowed = f"1 to {_LAST} units of depth_scale = {scale:g}"
        raise checks.reject(f"depth[{row}, {column}]", float(depth[row, column]), allowed)
    return np.where(mask, codes, 0.0)
