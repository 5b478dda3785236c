"""The package agrees with the naive twin bit for bit: on 504 drawn scenes, and on the built-in models."""

from __future__ import annotations

import ast
import hashlib
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from ibr_ref import displacement, models
from ibr_ref.displacement import Params, Scene
from ibr_ref.scene import BasePolygon, Camera, Light
from ibr_ref.testing.displacement import REGIONS
from ibr_ref.testing.displacement import Drawn as Case
from ibr_ref.testing.displacement import drawn as cases
from tests import drawn, naive
from tests.agreement import Arrays, arrays_of, check_agreement, check_without_stages
from tests.displacement.features import features
from tests.naive import displacement as twin

SCENES = 504

seen: Counter[str] = Counter()
"""In how many of the drawn scenes each feature occurred; "scenes" counts them all. No scene counts twice."""

frames: set[bytes] = set()
"""Digests of the scenes in `seen`."""

LEAST = {
    "out: something shown": 0.6 * SCENES,
    "out: hit protruded": 0.2 * SCENES,
    "out: hit relief": 0.05 * SCENES,
    "in: several polygons": 0.3 * SCENES,
    "out: tie of shade.lit_margin": 1,
}
"""Scenes that must show a feature, where that is not the usual `FEW`."""

FEW = 3


# --- Drawn scenes ----------------------------------------------------------------------------------------------------


def digest(arrays: Arrays) -> bytes:
    """Names a frame, to tell new ones from those already seen."""
    return hashlib.sha256(b"".join(array.tobytes() for array in arrays.values())).digest()


def agree(case: Case) -> None:
    """Compare a drawn scene, and count its features if it is a new one."""
    frame = check_agreement(displacement, twin, case.scene, case.params)
    check_without_stages(displacement, case.scene, case.params, frame)
    frames.add(digest(arrays_of(frame)))
    if len(frames) > seen["scenes"]:
        seen.update(["scenes", *features(case.scene, case.params, frame)])


def run_scene(number: int) -> None:
    """Compare two drawn scenes, with the eye in a region of its own."""
    drawn.run_scene(number, cases(REGIONS[number % len(REGIONS)]), agree)


@pytest.mark.parametrize("number", range(SCENES))
def test_drawn_scene_agrees(number: int, one_thread: None) -> None:
    run_scene(number)


EXPECTED = """
in: method protruded | method relief | method texture | interval paper | interval volume
in: faces auxiliary | faces base | faces extended | depth displaced | depth polygon
in: one linear step | linear steps | binary steps 0 | binary steps 1 | binary steps 2 | binary steps 3
in: binary steps 4 | binary steps 5 | binary steps 6 | threshold not positive
in: self-shadow protruded | self-shadow relief | self-shadow texture | no shadow bias
in: perspective | orthographic | sheared pixels | mirrored picture | direction from above | direction not from above
in: eye above the volume | eye above and aside | eye inside the volume | eye beside the volume | eye below the polygon
in: eye grazing the top | eye grazing the polygon | eye on u | eye on v | eye on h
in: point light | directional light | specular | exponent 0 | light below the horizon | light inside the volume
in: domain clip | domain repeat | map 1x1 | map 1xn | map nx1 | map nxn | large map | several polygons
in: sheared polygon | tilted polygon | height exactly 0 | height exactly 1 | spike of one texel
in: normal map | facade map | normal and facade map | no normal or facade map
out: something shown | nothing covers the pixel | kept but not shown | discarded | discarded at the near plane
out: near plane cuts a face | far plane cuts a face | guard band cuts a face | no faces
out: face 0 | face 1 | face 2 | face 3 | face 4 | face 5 | fragment on the border
out: tie of march.margin | tie of march.domain_margin | tie of march.steep_margin
out: tie of shade.lit_margin | tie of shade.axis_margin | tie of resolve.margin
out: hit protruded | hit relief | hit at the start of the ray | hit on the polygon | hit at the last lattice point
out: steep | facade | steep without facade | in shadow | several polygons shown | hidden fragments
"""
"""What must occur in the drawn scenes, each in at least `FEW` of them."""


def expected_features() -> list[str]:
    """The features of `EXPECTED`, with their prefixes."""
    rows = [row.split(": ") for row in EXPECTED.strip().splitlines()]
    return [f"{prefix}: {name}" for prefix, names in rows for name in names.split(" | ")]


def test_drawn_scenes_cover_every_feature(one_thread: None) -> None:
    if not seen:  # this test was chosen alone
        for number in range(SCENES):
            run_scene(number)
    assert seen["scenes"] >= SCENES, "Hypothesis drew some scenes twice"
    rare = {name: seen[name] for name in expected_features() if seen[name] < LEAST.get(name, FEW)}
    assert not rare, f"of {seen['scenes']} scenes too few show: {rare}"


# --- Built-in models -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module", params=["box", "city"])
def model(request: pytest.FixtureRequest) -> BasePolygon:
    return models.box() if request.param == "box" else models.city()


def test_models_agree(model: BasePolygon) -> None:
    size = float(np.linalg.norm(np.asarray(model.edge_u)))
    camera = Camera.look_at(eye=(0.9 * size, -1.1 * size, 0.7 * size), target=(0, 0, 0), width=160, height=120)
    scene = Scene(polygons=[model], camera=camera, light=Light(direction=(0.5, -0.8, 1.0), specular=0.3))
    frame = check_agreement(displacement, twin, scene, Params())
    check_without_stages(displacement, scene, Params(), frame)
    found = features(scene, Params(), frame)
    assert {"out: hit protruded", "out: hit on the polygon", "out: facade", "out: discarded"} <= found


# --- The twin itself -------------------------------------------------------------------------------------------------


def imported_modules(source: Path) -> set[str]:
    """Names of all modules that a file imports."""
    nodes = list(ast.walk(ast.parse(source.read_text())))
    names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    return names | {node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)}


def test_twin_shares_no_code_with_the_package() -> None:
    folder = Path(naive.__file__).parent
    sources = sorted(folder.glob("*.py"))
    assert len(sources) > 4
    for source in sources:
        assert not any(name.split(".")[0] in ("ibr_ref", "numba") for name in imported_modules(source)), source.name
