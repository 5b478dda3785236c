"""Small random cases that a right port passes: some ten pixels, texels and steps, so that each takes hundredths of a second.

They are adversarial (grazing eyes, maps of one row, ties, slivers, planes that cut) but clear of what the APIs leave
undefined, `oracle.undefined`. They shrink towards one pixel of one flat polygon, one point, or one plate over a floor.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from hypothesis import assume
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from ibr_ref import methods
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.cases.splatting import case as splatting_case
from ibr_ref.scene import Camera, Light, checks
from ibr_ref.shadows import prepare
from ibr_ref.testing import displacement, shadows, splatting
from ibr_ref.testing.numbers import real

PROFILE = "ieee32"
ABOUT = "Drawn at random."

PIXELS = st.tuples(st.integers(1, 16), st.integers(1, 16))
"""Width and height of pictures."""
TEXELS = st.tuples(st.integers(1, 7), st.integers(1, 7))
"""Rows and columns of height maps."""

NEAREST = 1e-4
"""Share of the far plane's distance at which the near plane lies at least: nearer ones need a guard band."""


def cases(method: str, system: str | None = None) -> SearchStrategy[Case]:
    """Of a method. Raises ValueError for one that has none.

    system: the one of those that its referee judges that draws them all: a search of displacement mapping ("relief"), a
    shape of splats, how shadows are made. Without: the protruded search; any shape; any shadows.
    """
    checks.choice("method", method, tuple(_CASES))
    if system is not None:
        checks.choice("system", system, methods.named(method).judged[1])
    return _CASES[method](system)


@st.composite
def displacement_cases(draw: DrawFn, search: str | None = None) -> Case:
    """Displacement mapping, by all parameters of a search."""
    found = draw(displacement.small(PIXELS, TEXELS, search or "protruded"))
    _assume_room(found.scene.camera)
    light = _with_a_power(found.scene.light)
    return Case(
        name="displacement-drawn",
        about=ABOUT,
        profile=PROFILE,
        scene=replace(found.scene, light=light),
        params=found.params,
    )


@st.composite
def _ellipses(draw: DrawFn, most: float) -> dict[str, float]:
    """Of splats that are averaged; a box has room for the filter."""
    found = {
        "footprint": draw(real(0.1, 2.0, 0.5)),
        "low_pass": draw(real(0.1, 1.5, 0.5)),
        "cutoff": draw(real(1.0, 4.0, 2.0)),
        "depth_tolerance": draw(real(0.0, 0.3, 0.0, 0.01)),
    }
    return {**found, "max_width": max(most, 2.5 * found["cutoff"] * found["low_pass"])}


@st.composite
def splatting_cases(draw: DrawFn, shape: str | None = None) -> Case:
    """Splatting of one to three depth images, by all its parameters."""
    found = draw(splatting.drawn())
    params = found.params
    if shape is not None:
        more: dict[str, Any] = draw(_ellipses(params.max_width)) if shape == "ellipse" else {}
        params = replace(params, shape=shape, **more)
    light = None if found.scene.light is None else _with_a_power(found.scene.light)
    return splatting_case("drawn", "own", ABOUT, PROFILE, replace(found.scene, light=light), params)


@st.composite
def shadow_cases(draw: DrawFn, method: str | None = None) -> Case:
    """Shadows by warped maps, by rendered ones, and by those of a grid."""
    found = draw(shadows.drawn(PIXELS))
    params = found.params
    if method is not None:
        samples = 1 if method == "pcss" else params.light_samples
        params = replace(params, method=method, light_samples=samples)
    _assume_room(found.scene.camera)
    maps = {"maps": prepare(found.scene, params, controls=found.controls)} if params.method == "warp" else {}
    return Case(name="shadows-drawn", about=ABOUT, profile=PROFILE, scene=found.scene, params=params, inputs=maps)


def _assume_room(camera: Camera) -> None:
    assume(camera.near > NEAREST * camera.far)


def _with_a_power(light: Light) -> Light:
    """A port's pow(0, 0) is undefined."""
    return replace(light, exponent=max(1, light.exponent))


_CASES = {"displacement": displacement_cases, "splatting": splatting_cases, "shadows": shadow_cases}
