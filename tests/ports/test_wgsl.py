"""The WGSL ports on every adapter of this machine, judged by the oracle."""

from __future__ import annotations

from typing import Any

import pytest

from ibr_ref import oracle
from ibr_ref.oracle import Outcome

CASES = [
    "displacement-slope",
    "displacement-tiles",
    "displacement-street",
    "displacement-sliver",
    "displacement-relief",
    "displacement-steep",
    "displacement-occlusion",
    "displacement-parallax",
    "splatting-lamp",
    "splatting-discs",
    "splatting-ellipses",
    "splatting-ovals",
    "shadows-soft",
    "shadows-pace",
    "shadows-direct",
    "shadows-masks",
    "shadows-penumbra",
]


@pytest.fixture(scope="module", params=["vulkan", "opengl"])
def device(request: pytest.FixtureRequest) -> Any:
    pytest.importorskip("wgpu", reason="wgpu, with which the ports draw, is not installed")
    from ibr_ref.ports.wgsl import gpu

    try:
        return gpu.create_device(request.param)
    except ValueError as error:
        pytest.skip(str(error))


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", CASES)
def test_the_port_passes(name: str, device: Any) -> None:
    """With all stages, as WebGPU declares itself."""
    from ibr_ref.ports.described import described
    from ibr_ref.ports.drawing import drawn

    case = oracle.build(name)
    frame = drawn(described(case.method, case.scene, case.params, **case.inputs), "wgsl", device)
    expected = {*case.frame.stages, "color", "depth"}
    arrays = {"color": frame.color, "depth": frame.depth, **frame.stages}
    verdict = oracle.examine(case, {n: a for n, a in arrays.items() if n in expected}, profile="webgpu").verdict
    assert verdict.outcome is Outcome.PASS, verdict.words()
    assert len(verdict.stages) >= 4, "hardly a stage was handed in: the test says little"


def test_adapters_are_chosen_by_their_words() -> None:
    pytest.importorskip("wgpu", reason="wgpu, with which the ports draw, is not installed")
    from ibr_ref.ports.wgsl import gpu

    if not gpu.adapters():
        pytest.skip("no adapter of WebGPU")
    with pytest.raises(ValueError, match=r"^adapter: found 'no such', allowed: words of '"):
        gpu.create_device("no such")
    assert gpu.create_device(gpu.adapters()[-1]).words == gpu.adapters()[-1]


def test_numbers_become_constants() -> None:
    pytest.importorskip("wgpu", reason="wgpu, with which the ports draw, is not installed")
    from ibr_ref.ports.wgsl import gpu

    lines = gpu.constants({"STEPS": 4, "BIAS": 1e-3, "LIT": True})
    assert lines == "const STEPS: i32 = 4;\nconst BIAS: f32 = 0.001;\nconst LIT: bool = true;\n"


def test_the_opengl_port_goes_on_beside_it() -> None:
    """WebGPU on OpenGL leaves a context of its own behind as the current one."""
    pytest.importorskip("wgpu", reason="wgpu, with which the ports draw, is not installed")
    pytest.importorskip("moderngl", reason="moderngl, with which the ports draw, is not installed")
    from ibr_ref.ports.described import described
    from ibr_ref.ports.drawing import drawn
    from ibr_ref.ports.glsl import gl
    from ibr_ref.ports.wgsl import gpu

    try:
        opengl, webgpu = gl.create_device(), gpu.create_device("opengl")
    except Exception as error:  # of moderngl, or of the loader that looks for EGL
        pytest.skip(str(error))
    case = oracle.build("displacement-box")
    given = described(case.method, case.scene, case.params)
    before = drawn(given, "glsl", opengl)
    drawn(given, "wgsl", webgpu)
    assert (drawn(given, "glsl", opengl).depth == before.depth).all()
