"""`ibr-ref render ... --case DIR`: anything that is rendered is a case."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ibr_ref import io, oracle
from ibr_ref.oracle import device, power
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line
from tests.oracle.tiny_cases import TINY


@pytest.fixture
def height(tmp_path: Path) -> Path:
    path = tmp_path / "height.png"
    io.write_image(path, np.random.RandomState(0).random_sample((6, 8, 1)).repeat(3, axis=2))
    return path


@pytest.mark.parametrize(
    ("method", "words"),
    [
        ("displacement", ("--height", "HEIGHT", "--steps", "5")),
        ("splatting", ("--mesh", "CUBE", "--count", "4", "--reference-size", "16")),
        ("splatting", ("--mesh", "CUBE", "--count", "4", "--reference-size", "16", "--shape", "ellipse")),
        ("shadows", ("--caster", "CUBE", "--map-size", "16", "--samples", "5")),
        ("shadows", ("--caster", "CUBE", "--map-size", "16", "--method", "direct")),
    ],
)
def test_what_is_rendered_is_a_case(
    run: Run, tmp_path: Path, height: Path, cube: Path, method: str, words: tuple[str, ...]
) -> None:
    options = [{"HEIGHT": height, "CUBE": cube}.get(word, word) for word in words]
    folder = tmp_path / "my case!"
    arguments = ("render", method, *options, "--size", "24x18", "--out", tmp_path / "a.png", "--case", folder)
    code, out, err = run(*arguments)
    assert code == 0, err
    assert f"{folder}: judges " in out
    case = oracle.load_case(folder)
    assert (case.name, case.method, case.kind) == ("my-case-", method, "own")
    assert case.about.startswith(f"ibr-ref render {method} {words[0]} ")
    assert case.profile == device.profile_of(case.undecided)
    assert f"meant for {case.profile}" in out
    np.testing.assert_array_equal(oracle.accept.bytes.color_bytes(case.frame.color), np.uint8(
        np.rint(255 * io.read_image(tmp_path / "a.png"))))  # fmt: skip
    (tmp_path / "drawn").mkdir()
    np.save(tmp_path / "drawn" / "color.npy", case.frame.color)
    assert run("check", folder, tmp_path / "drawn")[0] == 0


@pytest.mark.parametrize(("method", "option"), [("displacement", "exact"), ("shadows", "traced")])
def test_what_is_not_judged_is_no_case(
    run: Run, tmp_path: Path, height: Path, cube: Path, method: str, option: str
) -> None:
    given = {"displacement": ("--height", height), "shadows": ("--caster", cube)}[method]
    result = run("render", method, *given, "--method", option, "--out", tmp_path / "a.png", "--case", tmp_path / "case")
    assert_one_line(result, "--case", "judges no others")


def test_a_folder_with_other_things_is_refused_before_anything_is_rendered(
    run: Run, tmp_path: Path, height: Path
) -> None:
    out = tmp_path / "a.png"
    assert_one_line(run("render", "displacement", "--height", height, "--out", out, "--case", tmp_path), str(tmp_path))
    assert not out.exists()


@pytest.mark.parametrize("name", ["displacement-hill", "splatting-dots", "shadows-warp", "shadows-drawn"])
def test_a_scene_and_parameters_are_enough(name: str, tmp_path: Path) -> None:
    tiny = TINY[name]()
    case = oracle.Case(scene=tiny.scene, params=tiny.params, inputs=tiny.inputs if tiny.method == "shadows" else {})
    assert (case.name, case.method, case.kind) == (f"{tiny.method}-own", tiny.method, "own")
    oracle.export(case, tmp_path / "own")
    assert oracle.load_case(tmp_path / "own").profile in oracle.PROFILES
    with pytest.raises(ValueError, match=r"scene: found 'str', allowed: a Scene of displacement \| "):
        oracle.Case(scene="a scene", params=tiny.params)


def test_maps_must_be_given(tmp_path: Path) -> None:
    tiny = TINY["shadows-warp"]()
    with pytest.raises(ValueError, match=r"inputs\[.maps.\]: found 'NoneType', allowed: .*shadows.prepare"):
        oracle.export(oracle.Case(scene=tiny.scene, params=tiny.params), tmp_path / "own")


def test_how_much_a_case_judges() -> None:
    shares = {"ieee32": 0.001, "d3d11": 0.004, "vulkan": 0.006, "webgpu": 0.005, "gl": 0.76}
    assert device.profile_of(shares) == "webgpu"
    line = power.said(shares)
    assert line.startswith("judges 99.9 % under ieee32, 99.6 % under d3d11")
    assert line.endswith("24.0 % under gl (of the drawn pixels); meant for webgpu")
    assert "which is little" in power.said({"ieee32": 0.3, "gl": 0.4})
    assert device.profile_of({"ieee32": 0.3, "gl": 0.4}) == "ieee32"


def test_the_share_is_of_the_pixels_that_the_referee_leaves_open(monkeypatch: pytest.MonkeyPatch) -> None:
    case = TINY["displacement-hill"]()
    open_ = oracle.examine(case, {"color": case.frame.color}, profile="gl").verdict.undecided_share
    assert open_ is not None
    assert power.undecided(case)["gl"] >= open_ > 0
