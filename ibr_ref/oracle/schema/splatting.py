"""Scenes and parameters of splatting of depth images in `case.json`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from ibr_ref import splatting
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.schema.base import ArrayFile, Inputs, Model, Stored, Vector3, numbers, texels, values
from ibr_ref.oracle.schema.camera import CameraFile, build_camera, describe_camera
from ibr_ref.oracle.schema.document import Document, Schema
from ibr_ref.oracle.schema.light import LightFile, build_light, describe_light
from ibr_ref.scene import DepthImage, checks
from ibr_ref.splatting.references import prepare


class SplattingParams(Model):
    """The law of the width, W_s = alpha / (beta d^2 + gamma d + delta), and how splats are drawn; ellipses have no law."""

    alpha: float
    beta: float
    gamma: float
    delta: float
    min_width: float
    """Pixels."""
    max_width: float
    """Pixels."""
    shape: Literal["square", "disc", "ellipse"]
    max_atlas_size: int
    """Pixels a side of each of the atlas' four pages."""
    footprint: float = 0.5
    """shape = "ellipse": standard deviation of a point's Gaussian, in pixels of its reference image."""
    low_pass: float = 0.5
    """shape = "ellipse": standard deviation of the filter, in pixels of the picture."""
    cutoff: float = 2.0
    """shape = "ellipse": where the Gaussians end, in standard deviations."""
    depth_tolerance: float = 0.01
    """shape = "ellipse": share of the nearest splat's distance that those averaged with it may lie behind."""


class ImageFile(Model):
    """A reference image: every pixel inside the mask is a point. `vertex.source` names it by its index in the scene."""

    camera: CameraFile
    """Of the reference: intrinsics and world_from_view unproject its pixels."""
    color: ArrayFile
    depth: ArrayFile
    mask: ArrayFile
    normals: ArrayFile


class SplattingScene(Model):
    """Reference images of one object or place, seen by another camera."""

    camera: CameraFile
    """Of the picture."""
    light: LightFile | None
    """None: the images' own colours."""
    background: Vector3
    images: tuple[ImageFile, ...] = Field(min_length=1)


class SplattingCase(Document):
    """Splatting of depth images (Lee & Park 2006)."""

    method: Literal["splatting"]
    params: SplattingParams
    scene: SplattingScene


def _describe(case: Case, inputs: Inputs) -> tuple[SplattingParams, SplattingScene]:
    params = SplattingParams(**values(SplattingParams, case.params))
    return params, _scene(case.scene, case.inputs.get("normals"), inputs)


def _scene(scene: splatting.Scene, given: Sequence[Any] | None, inputs: Inputs) -> SplattingScene:
    """given: the images' normals; None: the reference's own."""
    normals = [_own_normals(image) for image in scene.images] if given is None else list(given)
    if len(normals) != len(scene.images):
        raise checks.reject('inputs["normals"]', f"{len(normals)} arrays", f"{len(scene.images)}, one an image")
    return SplattingScene(
        camera=describe_camera(scene.camera),
        light=None if scene.light is None else describe_light(scene.light),
        background=numbers(scene.background),
        images=tuple(_image(i, *pair, inputs) for i, pair in enumerate(zip(scene.images, normals, strict=True))),
    )


def _own_normals(image: DepthImage) -> NDArray[np.uint8]:
    return prepare(image).normals.reshape(image.arrays[0].shape)


def _image(index: int, image: DepthImage, normals: Any, inputs: Inputs) -> ImageFile:
    color, depth, mask = image.arrays
    if not isinstance(normals, np.ndarray) or normals.dtype != np.uint8 or normals.shape != color.shape:
        found = f"{getattr(normals, 'shape', '')} {getattr(normals, 'dtype', type(normals).__name__)}"
        raise checks.reject(f'inputs["normals"][{index}]', found, f"an array {color.shape} of uint8")
    stem = f"image{index}"
    code = "world-space normal, component = (k - 128) / 127, then normalized; (0, 0, 0) off the mask"
    return ImageFile(
        camera=describe_camera(image.camera),
        color=inputs.texture(f"{stem}.color", color, "linear colour"),
        depth=inputs.array(f"{stem}.depth", depth, "world units along the view axis, -z of view space; 0 off the mask"),
        mask=inputs.mask(f"{stem}.mask", mask, "which pixels are points"),
        normals=inputs.codes(f"{stem}.normals", normals, code),
    )


def _build(document: SplattingCase, stored: Stored) -> tuple[splatting.Scene, splatting.Params, dict[str, Any]]:
    file = document.scene
    images = [
        DepthImage(
            color=texels(stored, image.color),
            depth=texels(stored, image.depth),
            mask=texels(stored, image.mask),
            camera=build_camera(image.camera),
        )
        for image in file.images
    ]
    scene = splatting.Scene(
        images=images,
        camera=build_camera(file.camera),
        light=None if file.light is None else build_light(file.light),
        background=file.background,
    )
    normals = tuple(stored[image.normals.file] for image in file.images)
    return scene, splatting.Params(**document.params.model_dump()), {"normals": normals}


def _features(document: SplattingCase) -> set[str]:
    return {document.params.shape, "normals", "unlit" if document.scene.light is None else "phong"}


SCHEMA = Schema(document=SplattingCase, describe=_describe, build=_build, features=_features)
