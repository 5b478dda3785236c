"""The demo's pictures of splatting: figures 1, 3, 5 and 6 of Lee & Park 2006, on our own kettle and horse."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ibr_ref.demo.picture import SIZE, Picture, on_canvas

if TYPE_CHECKING:
    from ibr_ref.scene import Camera
    from ibr_ref.splatting import Params, Scene

SIZES = "640 x 480"
NOTE = "paper: GeForce 7800GTX, tables 1 and 2, as many points; `ibr-ref bench` measures with more care"
PICTURES = 10

WHITE = (1.0, 1.0, 1.0)


def pictures() -> list[Picture]:
    """References and a new view (1), the atlas (3), another light (5), splats near and far (6)."""
    references, view, *relit = _figures_1_and_5()
    return [references, view, *_figure_3(), *relit, *_figure_6()]


def _fitted(scene: Scene) -> Params:
    from ibr_ref import splatting

    law = splatting.fit_splat_law(scene.images, scene.camera)
    return splatting.Params(**law._asdict())


def _picture(name: str, caption: str, scene: Scene, params: Params, settings: str) -> Picture:
    from ibr_ref import splatting

    points = sum(int(image.arrays[2].sum()) for image in scene.images)
    return Picture(
        name=name,
        caption=caption,
        draw=lambda: splatting.render(scene, params, stages=False).color,
        frame=lambda: splatting.render(scene, params, stages=False),
        settings=f"{points:,} points, {settings}",
        paper_ms=f"{points / 25.74e6 * 1e3:.1f}",
    )


def _camera(**view: Any) -> Camera:
    from ibr_ref.scene import Camera

    return Camera.look_at(near=0.05, far=20.0, **SIZE, **view)


def _figures_1_and_5() -> list[Picture]:
    from ibr_ref import models, splatting
    from ibr_ref.scene import Light

    images = models.depth_rig(models.horse(), 9, size=320)
    view = _camera(eye=(2.4, -3.6, 2.2), target=(0.1, 0.0, 1.1), vertical_fov=38.0)
    baked = splatting.Scene(images=images, camera=view, light=None, background=WHITE)
    above = replace(baked, light=Light(direction=(0.5, -0.7, 1.0), ambient=0.25, diffuse=0.8, specular=0.2))
    below = replace(baked, light=Light(direction=(-1.0, -0.6, -0.3), ambient=0.25, diffuse=0.8, specular=0.2))
    params = _fitted(baked)
    return [
        Picture("splat_figure_1a", "1 (a) nine reference images", lambda: on_canvas(_montage(images))),
        _picture("splat_figure_1b", "1 (b) a new view, stored colours", baked, params, "fitted law"),
        _picture("splat_figure_5a", "5 (a) relit from above", above, params, "fitted law, lit"),
        _picture("splat_figure_5b", "5 (b) relit from the lower left", below, params, "fitted law, lit"),
    ]


def _montage(images: Any) -> Any:
    """Nine pictures, halved, in rows of three, the background white."""
    import numpy as np

    cells = []
    for image in images:
        color, _, mask = image.arrays
        shown = np.where(mask[..., None], color, 1.0)
        size = shown.shape[0] // 2
        cells.append(shown.reshape(size, 2, size, 2, 3).mean(axis=(1, 3)))
    return np.concatenate([np.concatenate(cells[row : row + 3], axis=1) for row in (0, 3, 6)])


def _figure_3() -> list[Picture]:
    """32 reference images of 80 x 80 in one texture."""
    from ibr_ref import models, splatting

    scene = splatting.Scene(
        images=models.depth_rig(models.kettle(), 32, size=80),
        camera=_camera(eye=(1.9, -2.2, 1.9), target=(0.15, 0.0, 0.5)),
        light=None,
    )
    params = splatting.Params(max_atlas_size=640)

    def atlas(name: str) -> Any:
        return splatting.render(scene, params).stages[f"atlas.{name}"][0]

    def depths() -> Any:
        depth = atlas("depth")
        nearest, farthest = depth[depth > 0].min(), depth.max()
        grey = ((farthest - depth) / (farthest - nearest) * 0.8 + 0.2) * (depth > 0)
        return on_canvas(grey[..., None].repeat(3, axis=2))

    return [
        Picture("splat_figure_3a", "3 (a) merged depth images", depths),
        Picture("splat_figure_3b", "3 (b) merged colour images", lambda: on_canvas(atlas("color"))),
        Picture("splat_figure_3c", "3 (c) normal map", lambda: on_canvas(atlas("normal") / 255.0)),
    ]


def _figure_6() -> list[Picture]:
    """The same points near and far, by the law; near with one pixel each there are holes."""
    from ibr_ref import models, splatting

    images = models.depth_rig(models.kettle(), 9, size=189)
    near = splatting.Scene(
        images=images,
        camera=_camera(eye=(1.3, -1.5, 1.4), target=(0.15, 0.0, 0.5)),
        light=None,
        background=WHITE,
    )
    far = replace(near, camera=_camera(eye=(2.9, -3.4, 2.7), target=(0.15, 0.0, 0.5)))
    law = splatting.fit_splat_law(images, near.camera)
    params = splatting.Params(**law._asdict())
    return [
        _picture("splat_figure_6a", "6 (a) one pixel a point, near", near, splatting.Params(), "1 pixel"),
        _picture("splat_figure_6b", "6 (b) width by the law, near", near, params, "fitted law"),
        _picture("splat_figure_6c", "6 (c) width by the law, far", far, params, "the same law"),
    ]
