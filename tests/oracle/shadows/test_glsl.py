"""The GLSL port on a real OpenGL, judged as any port is: the arrays that it reads back, and its picture alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest

from tests.oracle.shadows.judged import SMALL, Arrays, case, complaints, image, in_bytes, picture, stages

moderngl = pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")

from tests.ports.shadows import Port  # noqa: E402

PORTED = tuple(name for name in SMALL if name != "shadows-masks")
"""The port renders masks of one sample a texel, and refuses others; given ones it warps as they are."""


@pytest.fixture(scope="module")
def port() -> Iterator[Port]:
    try:
        yield Port()
    except Exception as error:
        pytest.skip(f"no headless OpenGL 4.5: {error}")


def read_back(port: Port, name: str) -> Arrays:
    described = case(name)
    frame = port.render(described.scene, described.params, maps=described.inputs.get("maps"))
    stages = {array: value for array, value in frame.stages.items() if not array.startswith("raster.")}
    return {**stages, "color": frame.color, "depth": frame.depth}


@pytest.mark.parametrize("name", PORTED)
def test_the_port_is_not_accused(port: Port, name: str) -> None:
    arrays = read_back(port, name)
    judged = [*stages(name, arrays, "gl"), image(name, picture(arrays), "gl")]
    assert {"warp", "depth", "project", "accumulate", "resolve"} <= {j.stage for j in judged}
    assert complaints(judged) == []


def test_its_maps_are_not_accused(port: Port) -> None:
    for name in ("shadows-box", "shadows-depths"):
        described = case(name)
        maps = port.maps(described.scene, described.params, described.inputs["maps"].positions)
        assert complaints(stages(name, {"maps.image": maps}, "gl")) == []


def test_its_bytes_are_not_accused(port: Port) -> None:
    arrays = read_back(port, "shadows-box")
    assert complaints([image("shadows-box", in_bytes(arrays), "gl")]) == []


def test_a_broken_port_is_accused(port: Port) -> None:
    """The port with an object that is a little off, and with a brighter shadow."""
    described = case("shadows-box")
    maps = described.inputs["maps"]
    for scene, stage in (
        (replace(described.scene, offset=(0.351, -0.4)), "warp"),
        (replace(described.scene, ambient=0.204), "resolve"),
    ):
        frame = port.render(scene, described.params, maps=maps)
        arrays = {k: v for k, v in frame.stages.items() if not k.startswith("raster.")}
        arrays |= {"color": frame.color, "depth": frame.depth}
        assert stage in {j.stage for j in stages("shadows-box", arrays, "gl") if j.wrong.any()}
        assert image("shadows-box", picture(arrays), "gl").wrong.any()
