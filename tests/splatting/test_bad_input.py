"""splatting/method.md, "Bad input": a ValueError that names the field, the value and what is allowed.

What a reference image, a camera and a light do not accept on their own is tested in tests/scene, what files do not in
tests/io; what the list of the page says of them is here once more. A law that fails in view: test_law.py; an atlas that
cannot fit: test_atlas.py.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from ibr_ref import Camera, DepthImage, Light, splatting
from ibr_ref.io import Frame
from ibr_ref.splatting import Params, Scene, coverage, fit_splat_law, render
from tests.splatting.scenes import looking, measured, noise

CAMERA = looking((0, -4, 0), size=(4, 3))
IMAGE = DepthImage(color=noise(3, 4, 3), depth=np.full((3, 4), 4.0), camera=CAMERA)
EMPTY = DepthImage(color=noise(3, 4, 3), depth=np.full((3, 4), np.nan), camera=CAMERA, mask=np.zeros((3, 4)))
VIEW = looking((0.5, -4, 0), size=(8, 6))
SCENE: dict[str, Any] = {"images": [IMAGE], "camera": VIEW, "light": None}

NOT_NUMBERS = [(np.nan, "nan"), (np.inf, "inf"), (-np.inf, "-inf"), ("a", "'a'"), ("1", "'1'"), (None, "None"), ([1], "[1]"),
               (1j, "1j"), (True, "True")]  # fmt: skip


def rejected(field: str, found: str, function: Callable[..., Any], *args: Any, **arguments: Any) -> None:
    """The call is rejected, with a message of one line: field: found ..., allowed: ..."""
    with pytest.raises(ValueError, match=rf"^{re.escape(field)}: found .*allowed: .") as error:
        function(*args, **arguments)
    assert found in str(error.value).split("allowed")[0]
    assert "\n" not in str(error.value)


LAW = ("alpha", "beta", "gamma", "delta", "min_width", "max_width")
ELLIPSE = ("footprint", "low_pass", "cutoff", "depth_tolerance")

PARAMS = [
    *((field, *row) for field in (*LAW, *ELLIPSE) for row in NOT_NUMBERS),
    *(("alpha", *row) for row in [(0.0, "0.0"), (-1.0, "-1.0"), (0, "0")]),
    *(("min_width", *row) for row in [(-1e-300, "-1e-300"), (2.0**20 + 1, "1048577.0")]),
    *(("max_width", *row) for row in [(0.5, "0.5"), (-1.0, "-1.0"), (2.0**21, "2097152.0")]),
    *(("shape", *row) for row in [("Square", "'Square'"), ("", "''"), (None, "None"), (1, "1"), (["disc"], "['disc']")]),
    *(("footprint", *row) for row in [(0.0, "0.0"), (8.5, "8.5")]),
    *(("low_pass", *row) for row in [(0.05, "0.05"), (9, "9")]),
    *(("cutoff", *row) for row in [(0.9, "0.9"), (8.1, "8.1")]),
    *(("depth_tolerance", *row) for row in [(-0.1, "-0.1"), (1.1, "1.1")]),
    *(("method", *row) for row in [("loop", "'loop'"), (None, "None"), ("Software", "'Software'")]),
    *(("max_atlas_size", *row) for row in [*NOT_NUMBERS, (0, "0"), (-4, "-4"), (2.5, "2.5"), (65537, "65537")]),
]  # fmt: skip


@pytest.mark.parametrize(("field", "value", "found"), PARAMS, ids=[f"{field}={found}" for field, _, found in PARAMS])
def test_a_parameter_out_of_range_is_named(field: str, value: Any, found: str) -> None:
    rejected(field, found, Params, **{field: value})


def test_a_width_below_the_least_is_named() -> None:
    rejected("max_width", "3.0", Params, min_width=4.0, max_width=3.0)
    rejected("max_width", "64.0", Params, min_width=65.0)


def test_ellipses_that_cannot_be_drawn_are_named() -> None:
    rejected("shape", "'ellipse'", Params, shape="ellipse", method="software")
    rejected("max_width", "7.9", Params, shape="ellipse", cutoff=4.0, low_pass=1.0, max_width=7.9)
    Params(shape="ellipse", cutoff=4.0, low_pass=1.0, max_width=8.0)
    Params(cutoff=4.0, low_pass=1.0, max_width=7.9)


def test_what_is_only_just_allowed_is_accepted() -> None:
    Params(alpha=5e-324, beta=-1.0, gamma=-1e300, delta=0.0, min_width=0.0, max_width=0.0)
    Params(min_width=2.0**20, max_width=2.0**20, shape="disc", max_atlas_size=1)
    assert type(Params(max_atlas_size=4.0).max_atlas_size) is int  # type: ignore[arg-type]
    assert type(Params(alpha=np.float32(2)).alpha) is float


SCENES = [
    ("images", [], "0 images with 0 valid pixels"),
    ("images", [EMPTY], "1 images with 0 valid pixels"),
    ("images", [EMPTY, EMPTY], "2 images with 0 valid pixels"),
    ("images", IMAGE, "DepthImage"),
    ("images", None, "NoneType"),
    ("images", 3, "int"),
    ("images[1]", [IMAGE, "an image"], "str"),
    ("images[0]", [None], "NoneType"),
    ("images[0]", np.ones((2, 3)), "ndarray"),
    ("images[0]", "ab", "str"),
    ("camera", None, "NoneType"),
    ("camera", IMAGE, "DepthImage"),
    ("light", (0, 0, 1), "tuple"),
    ("light", "none", "str"),
    ("light", False, "bool"),
    *(
        ("background", value, found)
        for value, found in [((0, 0, 1.5), "1.5"), ((0, -0.1, 0), "-0.1"), ((0, 0), "(0, 0)"), ((0, np.nan, 0), "nan"),
                             ("black", "'black'"), (0.5, "0.5"), (None, "None")]
    ),
]  # fmt: skip


@pytest.mark.parametrize(("field", "value", "found"), SCENES, ids=[f"{field}={found}" for field, _, found in SCENES])
def test_a_scene_without_sense_is_named(field: str, value: Any, found: str) -> None:
    rejected(field, found, Scene, **{**SCENE, field.split("[")[0]: value})


def test_the_light_must_be_said() -> None:
    """None is a light, too: one that forgets it does not get the other picture."""
    with pytest.raises(TypeError, match="light"):
        Scene(images=[IMAGE], camera=VIEW)  # type: ignore[call-arg]


def test_any_sequence_of_images_will_do_and_is_kept_as_it_was() -> None:
    images = [IMAGE, EMPTY]
    scene = Scene(images=images, camera=VIEW, light=None)
    images.clear()
    assert scene.images == (IMAGE, EMPTY)
    assert Scene(images=iter([IMAGE]), camera=VIEW, light=None).images == (IMAGE,)  # type: ignore[arg-type]
    assert render(scene).stages["vertex.source"][:, 0].max() == 0


FIT = [
    *(("tau", *row) for row in [*NOT_NUMBERS, (0.0, "0.0"), (1.01, "1.01"), (-0.5, "-0.5")]),
    *(("min_width", *row) for row in [*NOT_NUMBERS, (0.0, "0.0"), (-1.0, "-1.0")]),
    *(("max_width", *row) for row in [*NOT_NUMBERS, (0.5, "0.5")]),
]


@pytest.mark.parametrize(("field", "value", "found"), FIT, ids=[f"{field}={found}" for field, _, found in FIT])
def test_what_a_fit_does_not_take_is_named(field: str, value: Any, found: str) -> None:
    rejected(field, found, fit_splat_law, [IMAGE], VIEW, **{field: value})


def test_a_fit_takes_what_a_scene_takes() -> None:
    for images, field, found in [([], "images", "0 images"), ([EMPTY], "images", "0 valid"), (IMAGE, "images", "DepthImage"),
                                 ([IMAGE, 1], "images[1]", "int")]:  # fmt: skip
        rejected(field, found, fit_splat_law, images, VIEW)
    rejected("camera", "NoneType", fit_splat_law, [IMAGE], None)


def test_coverage_needs_the_stages() -> None:
    scene = Scene(**SCENE)
    rejected("frame.stages", "[]", coverage, scene, render(scene, stages=False))
    other = Frame(color=np.zeros((6, 8, 3)), depth=np.ones((6, 8)), stages={"march.hit": np.zeros(1)})
    rejected("frame.stages", "march.hit", coverage, scene, other)


K = measured((0, -4, 0), size=(4, 3)).intrinsics
CALIBRATED: dict[str, Any] = {"intrinsics": K, "rotation": np.eye(3), "translation": (0, 0, 0), "near": 1.0, "far": 9.0,
                              "width": 4, "height": 3}  # fmt: skip
AFX: dict[str, Any] = {"position": (0, 0, 0), "orientation": (0, 1, 0, 0.5), "field_of_view": (1.0, 0.8), "width": 4,
                       "height": 3}  # fmt: skip


def with_depth(value: float) -> np.ndarray:
    depth = np.full((3, 4), 4.0)
    depth[1, 2] = value
    return depth


def calibrated(**change: Any) -> Camera:
    return Camera.calibrated(**{**CALIBRATED, **change})


PAGE: list[tuple[str, str, Callable[[], Any]]] = [
    *(
        ("depth[1, 2]", str(bad), lambda bad=bad: DepthImage(color=IMAGE.color, depth=with_depth(bad), camera=CAMERA))
        for bad in (np.nan, np.inf, 0.0, -1.0)
    ),
    ("far", "1.0", lambda: calibrated(near=1.0, far=1.0)),
    ("far", "1.0", lambda: calibrated(near=9.0, far=1.0)),
    ("far", "1.0", lambda: Camera.axis_angle(**AFX, near=9.0, far=1.0)),
    ("far", "1.0", lambda: Camera.axis_angle(**AFX, near=9.0, far=1.0, orthographic=True)),
    ("far", "0.5", lambda: looking((0, -4, 0), near=1.0, far=0.5)),
    ("depth.shape", "(4, 3)", lambda: DepthImage(color=IMAGE.color, depth=np.ones((4, 3)), camera=CAMERA)),
    ("mask.shape", "(3, 5)", lambda: DepthImage(color=IMAGE.color, depth=IMAGE.depth, camera=CAMERA, mask=np.ones((3, 5)))),
    ("camera", "8 x 6", lambda: DepthImage(color=IMAGE.color, depth=IMAGE.depth, camera=VIEW)),
    ("intrinsics", "0.0", lambda: calibrated(intrinsics=K * [[0], [1], [1]])),
    ("intrinsics", "[0.0, 0.0, 0.0]", lambda: calibrated(intrinsics=np.zeros((3, 3)))),
    ("rotation", "1.001", lambda: calibrated(rotation=np.diag([1.001, 1, 1]))),
    ("rotation", "-1.0", lambda: calibrated(rotation=np.diag([1, 1, -1.0]))),
    ("view_from_world", "singular", lambda: Camera(view_from_world=np.diag([1, 1, 0, 1]), clip_from_view=VIEW.clip_from_view,
                                                   near=1, far=9, width=4, height=3)),
    ("images[0]", "4 x 3", lambda: render(Scene(**SCENE), Params(max_atlas_size=3))),
    ("beta, gamma, delta", "0 d^2 + 0 d + -1", lambda: render(Scene(**SCENE), Params(delta=-1.0))),
    ("images", "0 valid pixels", lambda: Scene(images=[EMPTY], camera=VIEW, light=None)),
]  # fmt: skip


@pytest.mark.parametrize(("field", "found", "make"), PAGE, ids=[f"{row[0]}={row[1]}" for row in PAGE])
def test_the_list_of_the_page(field: str, found: str, make: Any) -> None:
    rejected(field, found, make)


def test_a_measured_rotation_may_be_off_by_a_thousandth() -> None:
    """The Frobenius norm of R^T R - I: diag(1 + e, 1, 1) has 2 e + e^2."""
    calibrated(rotation=np.diag([1.000499, 1, 1]))
    rejected("rotation", "1.000501", calibrated, rotation=np.diag([1.000501, 1, 1]))


def test_positional_arguments_are_not_taken() -> None:
    for kind in (Params, Scene, DepthImage, Light):
        with pytest.raises(TypeError):
            kind(1.0)
    with pytest.raises(TypeError):
        render(Scene(**SCENE), Params(), False)  # type: ignore[misc]
    with pytest.raises(TypeError):
        splatting.fit_splat_law([IMAGE], VIEW, 0.9)  # type: ignore[misc]
