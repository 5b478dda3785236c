"""The GLSL port on a real OpenGL, judged as any port is: the arrays that it reads back, and its picture alone."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from tests.oracle.judgements import complaints, picture
from tests.oracle.splatting.judged import SMALL, Arrays, case, image, stages

moderngl = pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")

from ibr_ref.ports.described import described  # noqa: E402
from ibr_ref.ports.glsl.gl import Frame  # noqa: E402
from ibr_ref.ports.glsl.splatting import Port  # noqa: E402


@pytest.fixture(scope="module")
def port() -> Iterator[Port]:
    try:
        yield Port()
    except Exception as error:
        pytest.skip(f"no headless OpenGL 4.5: {error}")


def drawn(port: Port, name: str, codes: list[np.ndarray] | None = None, **options: Any) -> Frame:
    given = case(name)
    exported = described("splatting", given.scene, given.params, normals=codes or given.inputs["normals"])
    return port.render(exported.scene, exported.params, **options)


def handed(frame: Frame) -> Arrays:
    return {**frame.stages, "color": frame.color, "depth": frame.depth}


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("primitive", ["points", "quads"])
def test_the_port_is_not_accused(port: Port, primitive: str, name: str) -> None:
    params = case(name).params
    if primitive == "points" and (params.min_width < 1.0 or params.shape == "ellipse"):
        primitive = "quads"  # sprites are a pixel wide at least, and squares
    arrays = handed(drawn(port, name, primitive=primitive))
    judged = stages(name, arrays, "webgpu")
    assert [j.stage for j in judged] == ["vertex", "raster", "resolve"]
    assert complaints([*judged, image(name, picture(arrays), "webgpu")]) == []


def test_the_timed_variant_is_not_accused_by_its_bytes(port: Port) -> None:
    frame = drawn(port, "splatting-sprites", primitive="points", stages=False)
    color = np.rint(255.0 * frame.color).astype(np.uint8)
    assert complaints([image("splatting-sprites", {"color": color, "depth": frame.depth})]) == []


def test_a_broken_port_is_accused(port: Port) -> None:
    """The port with normals that are off by one code."""
    codes = case("splatting-sprites").inputs["normals"]
    moved = [np.where(each > 0, np.minimum(each.astype(int) + 1, 255), 0).astype(np.uint8) for each in codes]
    arrays = handed(drawn(port, "splatting-sprites", moved, primitive="quads"))
    assert [j.stage for j in stages("splatting-sprites", arrays) if j.wrong.any()] == ["vertex"]
    assert image("splatting-sprites", picture(arrays)).wrong.any()
