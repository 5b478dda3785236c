"""The method's measures of whole scenes: the law that fits, and how well a frame covers what the references know."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import Frame
from ibr_ref.scene import Camera, DepthImage, checks
from ibr_ref.splatting.coverage import Coverage, surface_pixels
from ibr_ref.splatting.inputs import Scene
from ibr_ref.splatting.references import prepare, view_of
from ibr_ref.splatting.size_law import MOST_SAMPLES, SplatLaw, fit, needed_widths
from ibr_ref.splatting.unproject import world_points


def fit_splat_law(
    images: Sequence[DepthImage],
    camera: Camera,
    *,
    tau: float = 0.95,
    min_width: float = 1.0,
    max_width: float = 64.0,
) -> SplatLaw:
    """The law alpha, beta, gamma, delta that makes splats wide enough for the share `tau` of the points in view.

    alpha = 1; beta, gamma, delta >= 0, with a denominator that is positive at all distances. min_width, max_width: pixels,
    those of the `Params` that the law is for. Compare laws by their widths, `law.width(d)`, not by coefficients. Raises
    ValueError if no point that has neighbours on its own surface is in view.
    """
    tau = checks.number("tau", tau, above=0.0, high=1.0)
    least = checks.number("min_width", min_width, above=0.0)
    most = checks.number("max_width", max_width, low=least)
    scene = Scene(images=images, camera=camera, light=None)
    references = [prepare(image) for image in scene.images]
    view = view_of(camera)
    stride = max(1, sum(reference.points for reference in references) // (8 * MOST_SAMPLES))
    found = [needed_widths(reference.reference, view, stride) for reference in references]
    distances, needed = (np.concatenate(arrays) for arrays in zip(*found, strict=True))
    if not len(distances):
        raise checks.reject("images", "no point in view that has neighbours", "at least one, to fit a law to")
    every = max(1, len(distances) // MOST_SAMPLES)
    return fit(distances[::every], needed[::every], tau, least, most)


def coverage(scene: Scene, frame: Frame) -> Coverage:
    """Coverage, holes and overdraw of a frame that was rendered from the scene with its stages.

    Raises ValueError for a frame without stages.
    """
    if "raster.overdraw" not in frame.stages:
        raise checks.reject("frame.stages", sorted(frame.stages), "those of splatting.render with stages=True")
    references = [prepare(image).reference for image in scene.images]
    return Coverage(
        covered=frame.stages["raster.splat"] >= 0,
        surface=surface_pixels(references, view_of(scene.camera)),
        overdraw=frame.stages["raster.overdraw"],
    )


def bounds(images: Sequence[DepthImage]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The corners (3,), low and high, of the box around all points of reference images, in world space.

    Raises ValueError if none of them has a valid pixel.
    """
    points = [world_points(prepare(image).reference) for image in images if np.any(image.mask)]
    if not points:
        raise checks.reject("images", f"{len(images)} images without a valid pixel", "at least one valid pixel")
    return (
        np.min([np.nanmin(p, axis=0) for p in points], axis=0),
        np.max([np.nanmax(p, axis=0) for p in points], axis=0),
    )
