"""The GLSL port on a real OpenGL, judged as any port is: the arrays that it reads back, and its picture alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from tests.oracle.judgements import complaints, in_bytes, picture
from tests.oracle.shadows.judged import SMALL, Arrays, case, image, stages

moderngl = pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")

from ibr_ref.ports.described import described  # noqa: E402
from ibr_ref.ports.glsl.shadows import Port  # noqa: E402


@pytest.fixture(scope="module")
def port() -> Iterator[Port]:
    try:
        yield Port()
    except Exception as error:
        pytest.skip(f"no headless OpenGL 4.5: {error}")


def read_back(port: Port, name: str, **changes: Any) -> Arrays:
    """The port's frame of an exported case, or of one with a scene that is changed under the same maps."""
    given = case(name)
    scene = replace(given.scene, **changes)
    exported = described("shadows", scene, given.params, **given.inputs)
    frame = port.render(exported.scene, exported.params)
    stages = {array: value for array, value in frame.stages.items() if not array.startswith("raster.")}
    return {**stages, "color": frame.color, "depth": frame.depth}


@pytest.mark.parametrize("name", SMALL)
def test_the_port_is_not_accused(port: Port, name: str) -> None:
    arrays = read_back(port, name)
    judged = [*stages(name, arrays, "gl"), image(name, picture(arrays), "gl")]
    assert {"warp", "depth", "project", "accumulate", "resolve"} <= {j.stage for j in judged}
    assert complaints(judged) == []


def test_its_maps_are_not_accused(port: Port) -> None:
    for name in ("shadows-box", "shadows-depths"):
        exported = described("shadows", case(name).scene, case(name).params, **case(name).inputs)
        maps = port.maps(exported.scene, exported.params)
        assert complaints(stages(name, {"maps.image": maps}, "gl")) == []


def test_its_bytes_are_not_accused(port: Port) -> None:
    arrays = read_back(port, "shadows-box")
    assert complaints([image("shadows-box", in_bytes(arrays), "gl")]) == []


@pytest.mark.parametrize(
    ("changes", "stage"),
    [({"offset": (0.351, -0.4)}, "warp"), ({"ambient": 0.204}, "resolve")],
    ids=["offset", "ambient"],
)
def test_a_broken_port_is_accused(port: Port, changes: dict[str, Any], stage: str) -> None:
    """The port with an object that is a little off, and with a brighter shadow."""
    arrays = read_back(port, "shadows-box", **changes)
    assert stage in {j.stage for j in stages("shadows-box", arrays, "gl") if j.wrong.any()}
    assert image("shadows-box", picture(arrays), "gl").wrong.any()
