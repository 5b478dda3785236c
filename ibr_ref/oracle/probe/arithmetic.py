"""How precisely a device adds, divides, takes roots and raises to powers: by the vertex stage of two reference images.

Of the first one everything is a multiple of a power of two: places, distances and the squares of their lengths are exact
sums, in whatever order they are taken. So a splat's width is one quotient of known numbers, and what the lamp gives to a
point whose normal is (0, 0, 1) is a component of a unit vector, a root and a quotient of known numbers: there a result is
compared with the exact one. The second image is seen by a camera of any numbers, under normals of all directions: sums of
what is rounded, and highlights, which are powers. The referee of the stage judges all points of both.

Each number is the first of its `RUNGS` that explains all points. A port that needs more than a correct rounding gets room:
its own errors may be larger elsewhere, as the probe is not every number.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Floats
from ibr_ref.models.surface_depths import ball_depths
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.declaration import ARITHMETIC, Declaration
from ibr_ref.oracle.device import LOOSEST, PROFILES
from ibr_ref.oracle.probe.measured import Measured
from ibr_ref.oracle.referees import referee
from ibr_ref.scene import Camera, DepthImage, Light, checks
from ibr_ref.splatting import Params, Scene, render

NEEDED = ("vertex.window", "vertex.depth", "vertex.width", "vertex.color")
"""What has to be handed in."""
CORRECT = 0.5
"""ULP of a correct rounding."""
RUNGS = (CORRECT, 1.0, 1.5, 2.5, 3.5, 4.5, 5.5)
"""ULP that are tried: correctly rounded, Direct3D's, a product with a reciprocal, Vulkan's quotients and its roots, and what
is taken for OpenGL's."""
ROOM = 0.8
"""All points have to be explained by so much of a rung already; a correct rounding is one, or it is none."""
SIZE = (40, 56)
"""Rows and columns of the exact image."""
LAMP = (1.5, 2.25, -2.0)
EXPONENT = 16
GRAZING = (0.02, 0.25)
"""Components of unit vectors, so small that their 16th power is nothing beside them: no highlight is added."""
PRODUCTS = 6.0
"""Of a 16th power, and of what it is multiplied by."""
SHINING = 0.5
"""Bases of powers."""
LITTLE = 0.02
"""UNIT: of what is computed here, and of the highlights that are left out."""
SEEN = 1e-4
"""Highlights below it are no powers that are counted."""


def probe_case() -> Case:
    """Points under a lamp that is near, in parallel lines of sight from the origin, down the z axis."""
    scene = Scene(
        images=[_exact(), _any()],
        camera=_down(view_height=9.1, width=160, height=120),
        light=Light(position=LAMP, ambient=0.0, diffuse=0.5, specular=0.5, exponent=EXPONENT),
        background=(0.0, 0.0, 0.0),
    )
    params = Params(alpha=6.7, gamma=1.0, delta=0.0, min_width=0.0)
    stages = render(scene, params).stages
    pages, rects = stages["atlas.normal"], stages["atlas.rects"].tolist()
    return Case(
        name="probe-arithmetic",
        method="splatting",
        kind="typical",
        about="Lit points, from which it is measured how precisely a device computes: `ibr-ref probe`.",
        profile="ieee32",
        scene=scene,
        params=params,
        inputs={"normals": [pages[page][y : y + h, x : x + w] for page, x, y, w, h in rects]},
    )


def _down(**size: Any) -> Camera:
    """From the origin down the z axis: the matrix of its place is the identity."""
    return Camera.orthographic(eye=(0, 0, 0), target=(0, 0, -1), up=(0, 1, 0), near=0.5, far=30.0, **size)


def _exact() -> DepthImage:
    """Four pixels a unit, depths in sixteenths. Neighbours are too far apart to count: normals are (0, 0, 1)."""
    random = np.random.default_rng(17)
    near = np.indices(SIZE).sum(axis=0) % 2 == 0  # as the lamp, or just beyond it
    depth = np.where(near, random.integers(33, 49, SIZE), random.integers(64, 321, SIZE)) / 16.0
    camera = _down(view_height=SIZE[0] / 4.0, width=SIZE[1], height=SIZE[0])
    return DepthImage(color=_colors(random, SIZE, 1.0), depth=depth, camera=camera)


def _any() -> DepthImage:
    """A ball."""
    camera = Camera.look_at(
        eye=(1.3, -1.6, -1.3), target=(0.1, 0.2, -5.05), vertical_fov=33.0, near=0.3, far=11.0, width=45, height=37
    )
    depth = ball_depths(camera, middle=(0, 0, -5))
    color = _colors(np.random.default_rng(19), depth.shape, 0.2)
    return DepthImage(color=color, depth=depth, camera=camera, mask=~np.isnan(depth))


def _colors(random: np.random.Generator, size: tuple[int, ...], least: float) -> Floats:
    """Red, in which light is seen, and nothing in the others, in which highlights are."""
    none = np.zeros(size)
    return np.stack([random.uniform(least, 1.0, size), none, none], axis=-1)


def measure(case: Case, arrays: Mapping[str, Any]) -> Measured:
    """Of a drawing of the case. Raises ValueError for arrays that are missing or have another size."""
    count = sum(int(image.arrays[2].sum()) for image in case.scene.images)
    for name in NEEDED:
        if name not in arrays:
            raise checks.reject("probe", f"no {name}", ", ".join(NEEDED))
        if np.shape(arrays[name])[:1] != (count,):
            raise checks.reject(name, np.shape(arrays[name]), "a row for each point")
    handed = {name: array for name, array in arrays.items() if name.partition(".")[0] in ("atlas", "vertex")}

    @np.errstate(all="ignore")
    def explains(numbers: Mapping[str, float]) -> bool:
        if not exact.within(numbers):
            return False
        judged = referee(case.method).judge_stages(case, Declaration(LOOSEST, numbers).device(LOOSEST), handed)
        return not any(judgement.wrong.any() for judgement in judged if judgement.stage == "vertex")

    exact = _exactly(case, arrays)
    numbers = found_by(explains)
    took_part = _took_part(case, arrays)
    return Measured(
        numbers, {name: f"{took_part[name]}, all of them within {ulps:g} ULP" for name, ulps in numbers.items()}
    )


def found_by(explains: Callable[[Mapping[str, float]], bool]) -> dict[str, float]:
    """The numbers by whether a device with some explains all points.

    Where sums are not correctly rounded all four are one, and a root is not more precise than quotients, as every unit
    vector has both: what one operation has too much of would hide what another has too little of.
    """
    if not explains({}):
        return {}
    correct = {"operation_ulps": CORRECT}
    if not explains(correct):
        rung = next((rung for rung in RUNGS if explains(_all(_asked(rung)))), None)
        return {} if rung is None else _all(rung)
    found, least = correct, CORRECT
    for name in [*ARITHMETIC][1:]:
        rungs = [rung for rung in RUNGS if rung >= (least if name == "root_ulps" else CORRECT)]
        rung = next((rung for rung in rungs if explains({**found, name: _asked(rung)})), None)
        if rung is None:
            break
        found, least = {**found, name: rung}, rung
    return found


def _all(rung: float) -> dict[str, float]:
    """Each number, but no larger than the loosest profile has it."""
    loosest = PROFILES[LOOSEST]
    most = (loosest.operation, loosest.quotient, loosest.root, loosest.logarithm)
    return {name: min(rung, np.floor(field) / 2.0) for name, field in zip(ARITHMETIC, most, strict=True)}


def _asked(rung: float) -> float:
    """What has to be enough."""
    return rung if rung == CORRECT else max(CORRECT, ROOM * rung)


class Exact(NamedTuple):
    """How far results of the first image are from the exact ones, in UNIT, and what of them is known; (n,) each."""

    sums: Floats
    """Of its windows, relative to the three terms that are rounded."""
    quotients: Floats
    least: Floats
    """Of the float32s that are nearest to the quotients."""
    roots: Floats
    powers: Floats
    bases: Floats

    def within(self, numbers: Mapping[str, float]) -> bool:
        """Whether a device of some numbers may have made them; those that are not said allow anything.

        Sums that are floats, and products and quotients by one, are taken to be exact on any device: where they are not, the
        numbers come out larger.
        """
        operation, quotient, root, power = (2.0 * numbers.get(name, np.inf) for name in ARITHMETIC)
        width = self.least if quotient <= 2.0 * CORRECT else quotient
        light = quotient + root
        logarithm = np.abs(np.log2(self.bases))
        intrinsic = EXPONENT * np.log(2.0) * (power * np.maximum(logarithm, 1.0) + operation * logarithm)
        shine = EXPONENT * light + PRODUCTS * operation + intrinsic + power * (1.0 + EXPONENT * logarithm)
        pairs = ((self.sums, operation), (self.quotients, width), (self.roots, light), (self.powers, shine))
        return all(bool((off <= legal + LITTLE).all()) for off, legal in pairs)


def _exactly(case: Case, arrays: Mapping[str, Any]) -> Exact:
    """Of the port's arrays."""
    image, camera = case.scene.images[0], case.scene.camera
    depth = image.arrays[1].reshape(-1)
    rows, columns = (index.reshape(-1) for index in np.indices(SIZE))
    x, y = (columns + 0.5 - SIZE[1] / 2.0) / 4.0, (SIZE[0] / 2.0 - rows - 0.5) / 4.0
    window, width, color = (np.asarray(arrays[f"vertex.{name}"], np.float64) for name in ("window", "width", "color"))
    scale = [float(np.float32(camera.clip_from_view[k, k])) for k in (0, 1)]
    sums = [
        _of_window(window[: depth.size, k], scale[k] * at, half)
        for k, at, half in ((0, x, camera.width / 2.0), (1, -y, camera.height / 2.0))
    ]
    quotient = float(np.float32(case.params.alpha)) / depth
    way = [there - here for there, here in zip(LAMP, (x, y, -depth), strict=True)]
    light = way[2] / np.sqrt(way[0] ** 2 + way[1] ** 2 + way[2] ** 2)
    grazing, shining = (light > GRAZING[0]) & (light < GRAZING[1]), light > SHINING
    return Exact(
        sums=np.concatenate(sums),
        quotients=_off(width[: depth.size], quotient),
        least=_off(quotient.astype(np.float32).astype(np.float64), quotient),
        roots=_off(color[: depth.size, 0][grazing], 0.5 * light[grazing]),
        powers=_off(color[: depth.size, 1][shining], 0.5 * light[shining] ** EXPONENT),
        bases=light[shining],
    )


def _of_window(found: Any, clip: Any, half: float) -> Floats:
    """(n,) of (clip + 1) half: a product, a sum and a product, each relative to itself."""
    exact = (clip + 1.0) * half
    return np.asarray(np.abs(found - exact) / (UNIT * (np.abs(half * clip) + 2.0 * np.abs(exact))), np.float64)


def _off(found: Floats, exact: Floats) -> Floats:
    return np.asarray(np.abs(found - exact) / (UNIT * np.abs(exact)), np.float64)


def _took_part(case: Case, arrays: Mapping[str, Any]) -> dict[str, str]:
    """How many different results each number is known from."""
    color = np.asarray(arrays["vertex.color"], np.float64)
    counts = {
        "operation_ulps": (arrays["vertex.window"], "sums and products"),
        "quotient_ulps": (arrays["vertex.width"], "quotients"),
        "root_ulps": (color[:, 0], "roots"),
        "power_ulps": (color[color[:, 1] > SEEN, 1], "powers"),
    }
    return {name: f"{len(np.unique(np.asarray(values)))} different {what}" for name, (values, what) in counts.items()}
