"""The systems that are compared: as the paper has them, and elliptical weighted averages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ibr_ref
from ibr_ref import splatting
from ibr_ref.scene import Camera, DepthImage
from ibr_ref.splatting import Params, Scene


class System(NamedTuple):
    """A way to draw the same images from the same camera."""

    name: str
    paper: str
    """Its column in tables 1 and 2; empty where the paper has none."""
    scene: Scene
    params: Params


def hand_set(images: Sequence[DepthImage], camera: Camera) -> Params:
    """A law as one sets it by hand: alpha/d, the size of a reference pixel that faces both cameras, times sqrt(2).

    The root lets the grid of the pixels be turned by any angle.
    """
    depths = np.concatenate([image.arrays[1][image.arrays[2]] for image in images])
    zoom = camera.intrinsics[1, 1] / images[0].camera.intrinsics[1, 1]
    return Params(alpha=math.sqrt(2.0) * zoom * float(np.median(depths)), gamma=1.0, delta=0.0)


def fitted(images: Sequence[DepthImage], camera: Camera) -> Params:
    """The law that `fit_splat_law` finds."""
    return Params(**splatting.fit_splat_law(images, camera)._asdict())


def constant(width: float) -> Params:
    """Points of one size, as a fixed-function pipeline draws them."""
    return Params(alpha=width)


def systems(scene: Scene, fit: Params) -> list[System]:
    """The five of tables 1 and 2, for a scene with a light; fit: the fitted law."""
    assert scene.light is not None
    baked = replace(scene, images=splatting.bake(scene.images, scene.light), light=None)
    return [
        System("law, fitted", "Shader", scene, fit),
        System("law, set by hand", "", scene, hand_set(scene.images, scene.camera)),
        System("constant 2 pixels, baked light", "OpenGL", baked, constant(2.0)),
        System("loop in software", "Software", scene, replace(fit, method="software")),
        System("elliptical weighted averages", "", scene, Params(shape="ellipse")),
    ]


def photographs() -> Path | None:
    """The folder of the Breakdancers frame, where it is: in this folder, or beside the package's repository."""
    beside = Path(ibr_ref.__file__).parents[2] / "shared" / "data" / "breakdancers"
    for folder in (Path("breakdancers"), beside):
        if (folder / "calibParams-breakdancers.txt").is_file():
            return folder
    return None
