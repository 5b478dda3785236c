"""The cases of splatting, by formula: the same bits on every machine.

No flat wall faces a camera and no two references share a point by accident: depths do not tie but where the same image is
given twice, which then ties on every device. Constant widths are multiples of 1/128, which have their borders on the raster
of 1/256 when drawn as quads; the widths of the case for point sprites are in [1, 64] and follow a law instead. No
background lies halfway between two bytes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref import models
from ibr_ref.array_types import Floats
from ibr_ref.models.surface_depths import ball_depths, plane_depths
from ibr_ref.oracle.cases.case import Case
from ibr_ref.scene import Camera, DepthImage, Light
from ibr_ref.splatting import Params, Scene, render


def case(name: str, kind: str, about: str, profile: str, scene: Scene, params: Params) -> Case:
    """With the reference's 8-bit normals as an input of ports."""
    frame = render(scene, params)
    pages = frame.stages["atlas.normal"]
    normals = [pages[page][y : y + h, x : x + w] for page, x, y, w, h in frame.stages["atlas.rects"].tolist()]
    return Case(
        name=f"splatting-{name}",
        method="splatting",
        kind=kind,
        about=about,
        profile=profile,
        scene=scene,
        params=params,
        inputs={"normals": normals},
    )


def ball() -> Case:
    """The easy one."""
    camera = looking((0.4, -3.0, 0.7), size=(56, 52))
    view = looking((0.9, -2.7, 0.9), size=(96, 72))
    scene = Scene(images=[painted(camera, ball_depths(camera))], camera=view, light=None, background=(0.11, 0.2, 0.31))
    about = "A ball in its own colours, by splats of two pixels."
    return case("ball", "easy", about, "ieee32", scene, Params(alpha=2.0))


def lamp() -> Case:
    """Measured cameras, masks, a highlight, a law of all parameters."""
    sizes = [(48, 33), (43, 36)]
    eyes = [(2.6, -2.2, 1.4), (-0.8, -3.2, 1.0)]
    cameras = [measured(eye, size=size, skew=2.0) for eye, size in zip(eyes, sizes, strict=True)]
    view = measured((1.2, -2.6, 0.9), size=(112, 84), skew=-1.5)
    light = Light(position=(1.0, -2.5, 2.0), ambient=0.2, diffuse=0.8, specular=0.6, exponent=60)
    images = [painted(camera, balls_on_the_ground(camera)) for camera in cameras]
    law = Params(alpha=3.7, beta=0.07, gamma=0.15, delta=0.2, min_width=2.9, max_width=3.7)
    about = (
        "Two measured cameras of balls on the ground in the light of a lamp: skew, masks, a highlight, all of the law."
    )
    scene = Scene(images=images, camera=view, light=light, background=(0.2, 0.4, 0.71))
    return case("lamp", "typical", about, "ieee32", scene, law)


def discs() -> Case:
    """Parallel lines of sight on either side."""
    camera = parallel((0.5, -4.0, 3.0), size=(20, 16))
    ground = plane_depths(camera, (0.03, 0.1, 1.0), -0.5)
    view = parallel((1.0, -4.0, 2.0), size=(128, 96), view_height=2.0)
    light = Light(direction=(0.8, 0.9, 0.5), ambient=0.2, diffuse=1.0, specular=0.5, exponent=40)
    images = [painted(camera, np.fmin(ball_depths(camera, 0.7), ground))]
    scene = Scene(images=images, camera=view, light=light, background=(0.51, 0.71, 0.91))
    about = "Orthographic on either side: large discs, narrower with the depth, overbright in the sun."
    return case("discs", "typical", about, "ieee32", scene, Params(alpha=21.0, gamma=0.5, max_width=12.5, shape="disc"))


def sprites() -> Case:
    """For point sprites and quads on any rasterizer: few and wide."""
    camera = looking((2.3, -1.9, 1.2), size=(15, 12))
    view = looking((1.9, -2.1, 1.5), size=(128, 96), vertical_fov=48.0)
    light = Light(position=(2.5, -1.0, 2.5), ambient=0.15, diffuse=0.7, specular=0.3, exponent=9)
    images = [painted(camera, ball_depths(camera))]
    scene = Scene(images=images, camera=view, light=light, background=(0.05, 0.11, 0.2))
    about = "A ball of wide splats, as point sprites or quads of any rasterizer draw them."
    return case("sprites", "typical", about, "gl", scene, Params(alpha=14.0, beta=0.05, gamma=0.1, delta=0.4))


def quads() -> Case:
    """For quads whose corners any rasterizer snaps: few, wide, of constant width."""
    camera = looking((0.4, -2.8, 1.1), size=(14, 13))
    view = looking((0.2, -3.1, 1.3), size=(128, 96))
    light = Light(direction=(0.4, -1.0, 0.8), ambient=0.25, diffuse=0.65, specular=0.25, exponent=12)
    scene = Scene(images=[painted(camera, ball_depths(camera))], camera=view, light=light, background=(0.6, 0.6, 0.55))
    about = "A ball of few wide splats of one width, in the sun, as quads whose corners are snapped one by one."
    return case("quads", "typical", about, "vulkan", scene, Params(alpha=11.0))


def shelves() -> Case:
    """Atlas pages, twins, noise."""
    sizes = [(12, 20), (20, 12), (20, 12), (12, 12), (32, 32), (24, 10)]
    eyes = [(3.0, 0.1, 1.0), (0.1, -3.0, 1.0), (-3.0, 0.0, 1.2), (0.5, 0.5, 4.0), (2.2, -2.2, 0.5), (0.0, 3.0, 0.5)]
    cameras = [looking(eye, size=size) for eye, size in zip(eyes, sizes, strict=True)]
    images = [noisy(camera, 3.0 + 0.3 * noise(camera.height, camera.width, seed=i)) for i, camera in enumerate(cameras)]
    view = looking((2.0, -2.0, 2.0), size=(96, 72), vertical_fov=50.0)
    about = "Seven images of noise on three pages of the atlas, one of them twice: all of its points tie."
    scene = Scene(images=[*images, images[1]], camera=view, light=None, background=(0.31, 0.6, 0.2))
    return case("shelves", "adversarial", about, "ieee32", scene, Params(alpha=3.25, max_atlas_size=32))


def terraces() -> Case:
    """Depths in eighths and thirty-seconds, floats all of them: neighbours that are as near as each other."""
    camera = parallel((0.6, -0.5, 8.0), size=(40, 28), view_height=2.0)
    levels = np.kron(np.floor(4.0 * noise(7, 10, seed=3)), np.ones((4, 4)))
    depth = 7.5 + 0.125 * levels + 0.03125 * np.floor(3.0 * noise(28, 40, seed=4))
    view = looking((1.1, -1.5, 5.1), size=(96, 72), vertical_fov=30.0)
    light = Light(position=(1.0, 2.0, 6.0), ambient=0.2, diffuse=0.7, specular=0.2, exponent=5)
    scene = Scene(images=[noisy(camera, depth)], camera=view, light=light, background=(0.0, 0.11, 0.0))
    about = "Terraces of exact depths: which neighbour a normal takes is a matter of ties, right and down."
    return case("terraces", "adversarial", about, "ieee32", scene, Params(alpha=2.75))


def among() -> Case:
    """An eye among the points."""
    camera = looking((0.0, 0.0, 4.0), size=(30, 24), up=(0, 1, 0), vertical_fov=60.0)
    image = noisy(camera, 2.5 + 3.0 * noise(24, 30, seed=2))
    view = Camera.axis_angle(
        position=(0.1, 0.0, 0.3),
        orientation=(1.0, 0.2, 0.0, 1.1),
        field_of_view=(1.6, 1.3),
        near=0.3,
        far=1.8,
        width=96,
        height=72,
    )
    light = Light(position=(0.1, 1.6, -0.8), specular=0.4, exponent=2)
    scene = Scene(images=[image], camera=view, light=light, background=(0.91, 0.51, 0.11))
    about = "An eye among the points, against the light: behind it, before the near plane, beyond the far one."
    return case("among", "adversarial", about, "ieee32", scene, Params(alpha=25.0, beta=2.0, delta=0.1, max_width=60.0))


def dust() -> Case:
    """Splats below a pixel."""
    camera = looking((0.3, -3.0, 0.6), size=(60, 48))
    view = looking((1.0, -1.9, 0.8), size=(96, 72))
    light = Light(direction=(1.0, -2.0, 1.0), ambient=0.1, specular=0.3, exponent=32)
    law = Params(alpha=1.0, beta=0.25, gamma=0.1, delta=0.3, min_width=0.25, max_width=1.5)
    image = painted(camera, ball_depths(camera), in_bytes=False)
    scene = Scene(images=[image], camera=view, light=light, background=(0.31, 0.31, 0.31))
    about = "A ball of splats smaller than a pixel, seen at a grazing angle, by a law that reaches both of its limits."
    return case("dust", "adversarial", about, "ieee32", scene, law)


def ellipses() -> Case:
    """Elliptical weighted averages of measured cameras, with all that bounds them."""
    eyes, sizes = [(2.5, -2.0, 1.1), (-0.2, -3.1, 0.8)], [(19, 15), (17, 16)]
    cameras = [measured(eye, size=size, skew=1.5) for eye, size in zip(eyes, sizes, strict=True)]
    view = measured((1.3, -2.4, 0.8), size=(96, 72), skew=-2.0)
    light = Light(position=(1.5, -2.5, 2.5), ambient=0.2, diffuse=0.7, specular=0.4, exponent=16)
    cameras.append(looking((-0.8, -3.2, 0.2), (0.35, -0.75, -0.53), size=(16, 12), vertical_fov=8.0))
    images = [painted(camera, balls_on_the_ground(camera)) for camera in cameras]
    scene = Scene(images=images, camera=view, light=light, background=(0.2, 0.31, 0.6))
    about = (
        "Measured cameras of balls on the ground, few pixels each, and one that sees it at a grazing angle, as ellipses "
        "that are averaged: flat ones, ones as large as is allowed, the ground behind a rim."
    )
    params = Params(shape="ellipse", footprint=0.6, low_pass=0.45, cutoff=2.2, max_width=21.0, depth_tolerance=0.06)
    return case("ellipses", "adversarial", about, "ieee32", scene, params)


def ovals() -> Case:
    """Parallel lines of sight, an image given twice, splats of which many are below a pixel."""
    camera = parallel((0.9, -3.0, 1.5), size=(30, 24), view_height=3.0)
    image = painted(camera, np.fmin(ball_depths(camera, 0.8), plane_depths(camera, (0.1, 0.05, 1.0), -0.7)))
    view = parallel((0.55, -0.74, 0.8), size=(64, 48), view_height=3.4)
    scene = Scene(images=[image, image], camera=view, light=None, background=(0.71, 0.51, 0.2))
    about = (
        "Orthographic on either side and unlit: small ellipses, mostly filter, each drawn twice; some before the view."
    )
    params = Params(shape="ellipse", footprint=0.45, low_pass=0.6, cutoff=1.7, max_width=9.0, depth_tolerance=0.01)
    return case("ovals", "adversarial", about, "ieee32", scene, params)


def kettle() -> Case:
    """640 x 480, a rig of nine."""
    images = models.depth_rig(models.kettle(), 9, size=300)
    view = looking((1.6, -1.3, 1.3), (0.15, 0.0, 0.45), size=(640, 480))
    light = Light(direction=(1.0, -1.0, 1.5), specular=0.5, exponent=24)
    scene = Scene(images=images, camera=view, light=light, background=(0.02, 0.03, 0.05))
    about = "A kettle from nine pictures, 210,000 points, at 640 x 480."
    return case("kettle", "real-sized", about, "ieee32", scene, Params(alpha=8.0, gamma=1.0, max_atlas_size=1024))


CASES: dict[str, Callable[[], Case]] = {
    f"splatting-{build.__name__}": build
    for build in (ball, lamp, discs, sprites, quads, shelves, terraces, among, dust, ellipses, ovals, kettle)
}
"""By name."""


def looking(eye: ArrayLike, target: ArrayLike = (0, 0, 0), *, size: tuple[int, int], **more: Any) -> Camera:
    """A perspective camera for pictures of that size, width and height."""
    view = {"vertical_fov": 40.0, "near": 0.5, "far": 20.0, "width": size[0], "height": size[1]}
    return Camera.look_at(eye=eye, target=target, **{**view, **more})


def parallel(eye: ArrayLike, *, size: tuple[int, int], view_height: float = 2.5) -> Camera:
    """An orthographic camera that looks at the origin."""
    return Camera.orthographic(
        eye=eye, target=(0, 0, 0), view_height=view_height, near=0.5, far=20.0, width=size[0], height=size[1]
    )


def measured(eye: ArrayLike, *, size: tuple[int, int], skew: float) -> Camera:
    """A calibrated camera: sheared pixels that are not square, the centre off the middle, a rotation off by 3e-4."""
    plain = looking(eye, size=size)
    k = plain.intrinsics * np.array([[1.0, 1.0, 1.0], [1.0, 0.97, 1.0], [1.0, 1.0, 1.0]])
    k = k + np.array([[0.0, skew, 0.3], [0.0, 0.0, -0.2], [0.0, 0.0, 0.0]])
    off = 3e-4 * np.array([[0.1, -0.2, 0.3], [0.2, 0.1, -0.1], [-0.3, 0.2, 0.1]])
    view = plain.view_from_world
    return Camera.calibrated(
        intrinsics=k,
        rotation=view[:3, :3] + off,
        translation=view[:3, 3],
        near=0.5,
        far=20.0,
        width=size[0],
        height=size[1],
    )


def noise(*shape: int, seed: int) -> Floats:
    """Random numbers in [0, 1)."""
    return np.random.RandomState(seed).random_sample(shape)


def painted(camera: Camera, depth: Floats, *, in_bytes: bool = True) -> DepthImage:
    """A reference image in smooth colours, bytes as they come from files, or any floats; off its mask too."""
    row, column = np.indices(depth.shape)
    red, green = column / camera.width, row / camera.height
    color = np.stack([0.2 + 0.7 * red, 0.9 - 0.8 * green, 0.3 + 0.2 * red * green], axis=2)
    color = _bytes(color) if in_bytes else color
    return DepthImage(color=color, depth=depth, camera=camera, mask=~np.isnan(depth))


def noisy(camera: Camera, depth: Floats) -> DepthImage:
    """A reference image in random colours."""
    color = noise(camera.height, camera.width, 3, seed=depth.size)
    return DepthImage(color=_bytes(color), depth=depth, camera=camera, mask=~np.isnan(depth))


def _bytes(color: Floats) -> Floats:
    return np.asarray(np.floor(255.0 * color + 0.5) / 255.0, np.float64)


def balls_on_the_ground(camera: Camera) -> Floats:
    """(H, W) depths of two balls over a tilted ground that ends somewhere; NaN beside them."""
    balls = np.fmin(ball_depths(camera, 0.7), ball_depths(camera, 0.3, (0.9, 0.2, 0.4)))
    ground = plane_depths(camera, (0.0, 0.1, 1.0), -0.6)
    return np.fmin(balls, np.where(ground < 6.0, ground, np.nan))
