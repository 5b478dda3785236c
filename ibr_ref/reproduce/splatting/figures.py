"""Figures 1, 3, 5 and 6, of our own models."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref import models, splatting
from ibr_ref.io import write_image
from ibr_ref.reproduce.findings import Claim, Figure, Found, Within
from ibr_ref.reproduce.splatting.canvas import cropped, enlarged, grid, side_by_side
from ibr_ref.reproduce.splatting.systems import fitted
from ibr_ref.scene import Camera, DepthImage, Light
from ibr_ref.splatting import Params, Scene

WHITE = (1.0, 1.0, 1.0)
PAPER_PAGE, PAPER_IMAGE, PAPER_COUNT = 1024, 256, 32
"""Figure 3: pixels a side of the merged texture and of a reference image, and how many of these."""


def run(folder: Path, within: Within) -> Found:
    """All four."""
    parts = []
    for done, part in enumerate((_figures_1_and_5, _figure_3, _figure_6)):
        within("figures", done, 3)
        parts.append(part(folder))
    return Found(
        figures=tuple(sorted((f for part in parts for f in part.figures), key=lambda figure: figure.title)),
        claims=tuple(claim for part in parts for claim in part.claims),
    )


def _camera(**view: Any) -> Camera:
    return Camera.look_at(near=0.05, far=20.0, **{"width": 640, "height": 480, **view})


def _figures_1_and_5(folder: Path) -> Found:
    images = models.depth_rig(models.horse(), 9, size=320)
    view = _camera(eye=(2.4, -3.6, 2.2), target=(0.1, 0.0, 1.1), vertical_fov=38.0)
    stored = Scene(images=images, camera=view, light=None, background=WHITE)
    params = fitted(images, view)
    plain = splatting.render(stored, params, stages=False).color
    references = grid([_on_white(image)[::2, ::2] for image in images], 3)
    write_image(folder / "figure-1.png", side_by_side([references, plain]))
    light = Light(direction=(-1.0, -0.6, -0.3), ambient=0.25, diffuse=0.8, specular=0.4, exponent=20)
    lit = splatting.render(replace(stored, light=light), params, stages=False).color
    baked = splatting.render(replace(stored, images=splatting.bake(images, light)), params, stages=False).color
    write_image(folder / "figure-5.png", side_by_side([plain, lit]))
    shown = (plain != 1.0).any(axis=2)
    moved = float(np.abs(lit - plain)[shown].mean())
    highlights = float((np.abs(lit - baked)[shown].max(axis=1) > 0.05).mean())
    return Found(
        figures=(
            Figure(
                title="Figure 1: reference images, and the object from any view",
                file="figure-1.png",
                caption="Nine reference images of our horse, and a view that none of them has, width by the fitted law.",
                published="the reference images of a SimpleTexture model and one view of it.",
            ),
            Figure(
                title="Figure 5: lighting",
                file="figure-5.png",
                caption="The stored colours, and lit from the lower left in the vertex stage.",
                published="a model as it was lit when it was taken, and lit from the lower left.",
            ),
        ),
        claims=(
            Claim(
                claim="Lighting is dynamic: surfaces are relit in the vertex stage.",
                published="figure 5",
                measured=f"a light from the lower left changes the object by {moved:.2f} of full brightness on average; "
                f"with the same light baked in, {highlights:.1%} of its pixels are off by more than 0.05",
                holds=moved > 0.05 and highlights > 0.0,
                why="Baked highlights stay where the reference cameras saw them; matt surfaces are the same bit for bit.",
            ),
        ),
    )


def _on_white(image: DepthImage) -> NDArray[np.float64]:
    color, _, mask = image.arrays
    return np.where(mask[..., None], color, 1.0)


def _figure_3(folder: Path) -> Found:
    """16 images of 256 x 256 fill the paper's texture; all 32 of them need two."""
    images = models.depth_rig(models.kettle(), 16, size=PAPER_IMAGE)
    view = _camera(eye=(1.9, -2.2, 1.9), target=(0.15, 0.0, 0.5), width=16, height=12)
    scene = Scene(images=images, camera=view, light=None)
    stages = splatting.render(scene, Params(max_atlas_size=PAPER_PAGE)).stages
    depth = stages["atlas.depth"][0]
    nearest, farthest = depth[depth > 0].min(), depth.max()
    grey = ((farthest - depth) / (farthest - nearest) * 0.8 + 0.2) * (depth > 0)
    maps = (grey[..., None].repeat(3, axis=2), stages["atlas.color"][0], stages["atlas.normal"][0] / 255.0)
    write_image(folder / "figure-3.png", side_by_side([m[::2, ::2] for m in maps]))
    held = (PAPER_PAGE // PAPER_IMAGE) ** 2
    pages = 1 + int(stages["atlas.rects"][-1, 0])
    return Found(
        figures=(
            Figure(
                title="Figure 3: merged depth and colour images, and the normals in 8 bits",
                file="figure-3.png",
                caption=f"16 references of the kettle, 256 x 256 each, in {pages} texture of {depth.shape[1]} x "
                f"{depth.shape[0]} (here at half its size). Near is bright; grey normals, (128, 128, 128), would be zero.",
                published="32 reference images of 256 x 256 merged into 1024 x 1024.",
            ),
        ),
        claims=(
            Claim(
                claim="32 reference images of 256 x 256 are merged into one texture of 1024 x 1024.",
                published="section 3.3 and figure 3",
                measured=f"{held} fit into one; 32 take {-(-PAPER_COUNT // held)}",
                holds=held >= PAPER_COUNT,
                why="16 colour and 16 depth images are 32: so the paper may count them.",
            ),
            _normals_claim(),
        ),
    )


def _normals_claim() -> Claim:
    """A sphere by formula, its true normals beside those that are found from its depths, exact and in 8 bits."""
    camera = Camera.look_at(eye=(0, -3, 0), target=(0, 0, 0), vertical_fov=40, near=1, far=9, width=256, height=256)
    y, x = (np.mgrid[:256, :256] + 0.5 - 128.0) / camera.intrinsics[1, 1]
    way = 1.0 + x * x + y * y
    with np.errstate(invalid="ignore"):
        depth = (3.0 - np.sqrt(9.0 - 8.0 * way)) / way
    mask = np.isfinite(depth)
    codes = np.round((1 / depth - 1 / 3.0) / (1 / 2.0 - 1 / 3.0) * 255.0) / 255.0
    stepped = 1.0 / (codes * (1 / 2.0 - 1 / 3.0) + 1 / 3.0)
    true = np.stack([x * depth, depth - 3.0, -y * depth], axis=2)[mask]
    quantized = _decoded(np.floor(127.0 * true + 128.5))
    errors = [_degrees(quantized, true)]
    for taken in (depth, stepped):
        image = DepthImage(color=np.ones((256, 256, 3)), depth=taken, camera=camera, mask=mask)
        scene = Scene(images=[image], camera=camera, light=None)
        errors.append(_degrees(_decoded(splatting.render(scene).stages["atlas.normal"][0][mask]), true))
    return Claim(
        claim="8 bits suffice for normals: those estimated from depth are farther off than that.",
        published="section 3.4, no figures",
        measured=f"rounding to 8 bits {errors[0]:.2f} degrees on average; estimated on a sphere from exact depths "
        f"{errors[1]:.2f}, from depths of 8 bits {errors[2]:.1f}",
        holds=errors[0] < min(errors[1:]),
    )


def _decoded(codes: NDArray[Any]) -> NDArray[np.float64]:
    normals = (codes.astype(np.float64) - 128.0) / 127.0
    result: NDArray[np.float64] = normals / np.sqrt((normals * normals).sum(axis=1))[:, None]
    return result


def _degrees(normals: NDArray[np.float64], true: NDArray[np.float64]) -> float:
    """Mean angle between unit vectors."""
    return float(np.degrees(np.arccos(np.clip((normals * true).sum(axis=1), -1.0, 1.0))).mean())


def _figure_6(folder: Path) -> Found:
    """The tiles of a floor: near splats are wide, far ones narrow."""
    image = _floor()
    view = _camera(eye=(0.0, -2.2, 0.9), target=(0.0, 1.0, 0.0), vertical_fov=50.0)
    scene = Scene(images=[image], camera=view, light=None, background=WHITE)
    params = fitted(scene.images, view)
    law, single = splatting.render(scene, params), splatting.render(scene, Params())
    holes = [100.0 * splatting.coverage(scene, frame).hole_share for frame in (single, law)]
    window, width = law.stages["vertex.window"], law.stages["vertex.width"]
    inside = (width > 0) & (window >= 0).all(axis=1) & (window < (640, 480)).all(axis=1)
    rows = window[inside, 1]
    far, near = (float(width[inside][part].mean()) for part in (rows < np.quantile(rows, 0.1), rows > 400))
    parts = [enlarged(cropped(law.color, 280, row, 80, 79), 3) for row in (int(rows.min()) + 4, 396)]
    write_image(folder / "figure-6.png", side_by_side([single.color, law.color, grid(parts, 1)]))
    return Found(
        figures=(
            Figure(
                title="Figure 6: the size of splats by distance",
                file="figure-6.png",
                caption="A floor whose every point has a brightness of its own: one pixel a point, the fitted law, and a "
                "far and a near part of this, enlarged.",
                published="splats of a far face smaller than those of a near one.",
            ),
        ),
        claims=(
            Claim(
                claim="Splats whose size follows the distance close the holes of a magnified object.",
                published="section 3.5 and figure 6",
                measured=f"{holes[0]:.1f} % holes with one pixel a point, {holes[1]:.2f} % with the law; widths from "
                f"{far:.1f} pixels (the farthest tenth) to {near:.1f} (the nearest rows)",
                holds=holes[1] < 0.05 * holes[0] and near > far,
            ),
        ),
    )


def _floor() -> DepthImage:
    """Seen from straight above, tiles and grains by formula."""
    size = 256
    camera = Camera.orthographic(
        eye=(0, 1.0, 2), target=(0, 1.0, 0), up=(0, 1, 0), view_height=6.0, near=1, far=3, width=size, height=size
    )
    row, column = np.mgrid[:size, :size]
    tiles = ((row // 32 + column // 32) % 2)[..., None]
    grains = (0.65 + 0.35 * ((row * 57 + column * 39) % 101) / 100.0)[..., None]
    color = np.where(tiles == 1, (0.85, 0.45, 0.25), (0.35, 0.6, 0.85)) * grains
    return DepthImage(color=color, depth=np.full((size, size), 2.0), camera=camera)
