"""The GLSL port on a real OpenGL, judged as any port is: the arrays that it reads back, and its picture alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from tests.oracle.splatting.judged import SMALL, Arrays, case, complaints, image, picture, stages

moderngl = pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")

from tests.ports.splatting import Port  # noqa: E402

BYTES = tuple(name for name in SMALL if name != "splatting-dust")
"""The port stores colours in bytes, and refuses others; point sprites below a pixel, too."""


@pytest.fixture(scope="module")
def port() -> Iterator[Port]:
    try:
        yield Port()
    except Exception as error:
        pytest.skip(f"no headless OpenGL 4.5: {error}")


def read_back(port: Port, name: str, primitive: str) -> Arrays:
    described = case(name)
    frame = port.render(described.scene, described.params, primitive=primitive, normals=described.inputs["normals"])
    return {**frame.stages, "color": frame.color, "depth": frame.depth}


@pytest.mark.parametrize("name", BYTES)
@pytest.mark.parametrize("primitive", ["points", "quads"])
def test_the_port_is_not_accused(port: Port, primitive: str, name: str) -> None:
    arrays = read_back(port, name, primitive)
    judged = stages(name, arrays, "webgpu")
    assert [j.stage for j in judged] == ["vertex", "raster", "resolve"]
    assert complaints([*judged, image(name, picture(arrays), "webgpu")]) == []


def test_the_timed_variant_is_not_accused_by_its_bytes(port: Port) -> None:
    described = case("splatting-sprites")
    options = {"primitive": "points", "stages": False, "normals": described.inputs["normals"]}
    frame = port.render(described.scene, described.params, **options)
    color = np.rint(255.0 * frame.color).astype(np.uint8)
    assert complaints([image("splatting-sprites", {"color": color, "depth": frame.depth})]) == []


def test_a_broken_port_is_accused(port: Port) -> None:
    """The port with normals that are off by one code."""
    described = case("splatting-sprites")
    codes = [
        np.where(each > 0, np.minimum(each.astype(int) + 1, 255), 0).astype(np.uint8)
        for each in described.inputs["normals"]
    ]
    frame = port.render(described.scene, described.params, primitive="quads", normals=codes)
    judged = stages("splatting-sprites", {**frame.stages, "color": frame.color, "depth": frame.depth})
    assert [j.stage for j in judged if j.wrong.any()] == ["vertex"]
    assert image("splatting-sprites", {"color": frame.color, "depth": frame.depth}).wrong.any()
