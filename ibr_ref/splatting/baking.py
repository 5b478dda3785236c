"""Lighting baked into reference images: what fixed-function points show (the paper's comparison, tables 1 and 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ibr_ref.scene import DepthImage, Light, checks
from ibr_ref.splatting.buffers import Lighting
from ibr_ref.splatting.references import lighting_of, prepare, view_of
from ibr_ref.splatting.vertex import color_vertices


def bake(images: Sequence[DepthImage], light: Light) -> list[DepthImage]:
    """The images with colours lit as their own cameras see them; drawn without a light they keep these from any view.

    Diffuse light does not depend on the eye: baked or not, the same colours, bit for bit. Highlights stay where the
    reference cameras saw them. Raises ValueError for what is no image or no light.
    """
    if not isinstance(light, Light):
        raise checks.reject("light", type(light).__name__, "Light")
    for i, image in enumerate(images):
        if not isinstance(image, DepthImage):
            raise checks.reject(f"images[{i}]", type(image).__name__, "DepthImage")
    lighting = lighting_of(light)
    return [_baked(image, lighting) for image in images]


def _baked(image: DepthImage, lighting: Lighting) -> DepthImage:
    prepared, view = prepare(image), view_of(image.camera)
    reference = prepared.reference
    lit, color = np.empty((prepared.points, 3)), reference.color.copy()
    color_vertices(reference, prepared.normals, lighting, view, 0, len(reference.row_starts) - 1, lit)
    color[reference.pixels] = lit
    return replace(image, color=color.reshape(np.shape(image.color)))
