"""What the method is given: reference images before a camera, and the law of the splats' width."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from numpy.typing import ArrayLike

from ibr_ref.choices import DRAWN_BY, SHAPES
from ibr_ref.pipeline.ellipses import MOST_CUTOFF
from ibr_ref.scene import Camera, DepthImage, Light, checks, limits
from ibr_ref.scene.documented import documented
from ibr_ref.scene.limits import Limit, Real, Whole, Word

READ_BY: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("alpha", "beta", "gamma", "delta", "min_width"), ("square", "disc")),
    **dict.fromkeys(("footprint", "low_pass", "cutoff", "depth_tolerance"), ("ellipse",)),
}
"""Fields of `Params` that only some shapes read, and these."""

MOST_POINTS = 2**31 - 1
"""Points of a scene: their indices are 32-bit integers."""

WIDEST = 2.0**20
"""Largest width of a splat, pixels."""

LIMITS: dict[str, Limit] = {
    "alpha": Real(above=0.0),
    "beta": Real(),
    "gamma": Real(),
    "delta": Real(),
    "min_width": Real(low=0.0, high=WIDEST),
    "max_width": Real(low=0.0, high=WIDEST),
    "shape": Word(SHAPES),
    "footprint": Real(above=0.0, high=8.0),
    "low_pass": Real(low=0.1, high=8.0),
    "cutoff": Real(low=1.0, high=MOST_CUTOFF),
    "depth_tolerance": Real(low=0.0, high=1.0),
    "method": Word(DRAWN_BY),
    "max_atlas_size": Whole(1, 65536),
}
"""Of the fields of `Params`, each by itself."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """Reference images of one object or place, seen by another camera. On a tie in depth the earlier image wins.

    Raises ValueError if there is no image, none of them has a valid pixel, or something is not what it should be.
    """

    images: Sequence[DepthImage]
    """At least one; `vertex.source` names them by their index here."""
    camera: Camera
    light: Light | None
    """None: the images' own colours."""
    background: ArrayLike = (0.0, 0.0, 0.0)
    """(3,) linear colour where nothing is shown, in [0, 1]."""

    def __post_init__(self) -> None:
        if isinstance(self.images, DepthImage) or not isinstance(self.images, Iterable):
            raise checks.reject("images", type(self.images).__name__, "a sequence of DepthImage")
        images = tuple(self.images)
        object.__setattr__(self, "images", images)
        for i, image in enumerate(images):
            if not isinstance(image, DepthImage):
                raise checks.reject(f"images[{i}]", type(image).__name__, "DepthImage")
        points = sum(int(image.arrays[2].sum()) for image in images)
        if not 0 < points <= MOST_POINTS:
            found = f"{len(images)} images with {points} valid pixels (mask)"
            raise checks.reject("images", found, f"from 1 to {MOST_POINTS} valid pixels in all")
        if not isinstance(self.camera, Camera):
            raise checks.reject("camera", type(self.camera).__name__, "Camera")
        if self.light is not None and not isinstance(self.light, Light):
            raise checks.reject("light", type(self.light).__name__, "Light, or None for the images' own colours")
        object.__setattr__(self, "background", checks.color("background", self.background))


@documented("shape", READ_BY)
@dataclass(frozen=True, kw_only=True)
class Params:
    """The law of the width, W_s = alpha / (beta d^2 + gamma d + delta), and how splats are drawn (section 3.3).

    d is the distance from the eye to the point in world units (orthographic: along the view axis). The defaults are a
    constant width of one pixel. The denominator must be positive for every point in view, or `render` raises ValueError.
    """

    alpha: float = 1.0
    """> 0, pixels."""
    beta: float = 0.0
    gamma: float = 0.0
    delta: float = 1.0
    min_width: float = 1.0
    """Pixels, >= 0."""
    max_width: float = 64.0
    """Pixels, >= min_width."""
    shape: str = "square"
    """"square" | "disc": nearest splat wins, as in the paper | "ellipse": elliptical weighted averages (Zwicker et al.
    2001), whose size follows from the normals, not from the law, and is bounded by `max_width` alone."""
    footprint: float = 0.5
    """shape="ellipse": standard deviation of a point's Gaussian, in pixels of its reference image; in (0, 8]."""
    low_pass: float = 0.5
    """shape="ellipse": standard deviation of the filter of the picture's pixels; in [0.1, 8]."""
    cutoff: float = 2.0
    """shape="ellipse": where the Gaussians end, in standard deviations; in [1, 8]."""
    depth_tolerance: float = 0.01
    """shape="ellipse": splats at most this share of the distance along the view axis behind the nearest are averaged with
    it; in [0, 1]."""
    method: str = "shader"
    """"shader": the stages of the paper, each over many points | "software": the loop that it is compared with (table 1),
    one point after another on one thread; the same picture, and no ellipses."""
    max_atlas_size: int = 4096
    """Pixels a side of each of the atlas' four pages."""

    def __post_init__(self) -> None:
        limits.check(self, LIMITS)
        checks.number("max_width", self.max_width, low=self.min_width)
        self._check_ellipses()

    def _check_ellipses(self) -> None:
        """What the choice of ellipses needs of the other fields."""
        if self.shape != "ellipse":
            return
        if self.method == "software":
            raise checks.reject("shape", self.shape, "square | disc, with method='software'")
        if self.max_width < 2.0 * self.cutoff * self.low_pass:
            raise checks.reject("max_width", self.max_width, ">= 2 cutoff low_pass, with shape='ellipse'")
