"""The engine between referees and verdicts, with a referee that only compares."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle import bias
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import LOOSEST, PROFILES
from ibr_ref.oracle.examination import examine
from ibr_ref.oracle.findings import Outcome
from ibr_ref.oracle.verdict import Verdict
from tests.oracle.plain_referee import box_case

pytestmark = pytest.mark.usefixtures("plain_referee")


def stages(case: object) -> dict[str, np.ndarray]:
    frame = case.frame  # type: ignore[attr-defined]
    return {
        "color": frame.color.copy(),
        **{k: v.copy() for k, v in frame.stages.items() if k.startswith(("raster", "march"))},
    }


def test_the_reference_passes_by_the_tightest_profile() -> None:
    case = box_case()
    examination = examine(case, stages(case))
    verdict = examination.verdict
    assert verdict.outcome is Outcome.PASS
    assert verdict.profile == "ieee32"
    assert verdict.tried == {"ieee32": 0}
    assert not verdict.declared
    assert "PASS: displacement-test" in verdict.words()
    image = examination.judgement("image")
    assert image is not None
    drawn = image.undecided | (case.frame.depth < 1.0)
    assert 0 < image.undecided.sum() < drawn.sum() < drawn.size, "of what is drawn, not of the background"
    assert verdict.undecided_share == pytest.approx(image.undecided.sum() / drawn.sum())


def test_a_looser_profile_is_found_and_a_declared_one_is_kept() -> None:
    case = box_case()
    handed = {"color": case.frame.color + 2e-4}
    verdict = examine(case, handed).verdict
    assert (verdict.outcome, verdict.profile) == (Outcome.PASS, "gl")
    assert [*verdict.tried] == [LOOSEST, *(name for name in PROFILES if name != LOOSEST)]
    declared = examine(case, handed, profile="vulkan").verdict
    assert (declared.outcome, declared.profile, declared.declared) == (Outcome.FAIL, "vulkan", True)


def test_the_first_wrong_stage_is_named_with_a_witness_away_from_undecided_pixels() -> None:
    case = box_case()
    handed = stages(case)
    handed["march.hit_index"][0, 3] += 1
    handed["march.hit_index"][40, 50:60] += 1
    handed["color"][40, 50:60] = 0.5
    verdict = examine(case, handed).verdict
    assert verdict.outcome is Outcome.FAIL
    assert verdict.first_wrong_stage == "march"
    raster, march, image = verdict.stages
    assert raster.right
    assert (march.wrong, march.blamed, march.box.first, march.box.last) == (
        11,
        {"march.hit_index": 11},
        (0, 3),
        (40, 59),
    )
    assert image.wrong == 10
    assert verdict.witness is not None
    assert verdict.witness.index == (40, 50)
    assert verdict.witness.array == "march.hit_index"
    text = verdict.words()
    for part in ("first wrong in stage march", "11 pixels wrong", "h < H", "margin 0.25", "Witness: pixel [40, 50]"):
        assert part in text
    assert Verdict.model_validate_json(verdict.model_dump_json()) == verdict


@pytest.mark.parametrize(
    ("name", "mistake"),
    [
        ("rows from the bottom up", lambda c: c[::-1]),
        ("columns from right to left", lambda c: c[:, ::-1]),
        ("channels in the order BGR", lambda c: c[..., ::-1]),
        ("a shift by one row", lambda c: np.roll(c, 1, 0)),
        ("colours encoded as sRGB", lambda c: np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)),
    ],
)
def test_conventions_that_explain_are_named(name: str, mistake: object) -> None:
    case = box_case()
    verdict = examine(case, {"color": mistake(case.frame.color.copy())}).verdict  # type: ignore[operator]
    assert verdict.outcome is Outcome.FAIL
    assert verdict.conventions[0].name == name
    assert verdict.conventions[0].explains
    assert f"{name} would explain all of it" in verdict.words()


def test_a_half_pixel_shift_is_named() -> None:
    from ibr_ref.oracle.conventions import _with_camera

    case = box_case()
    camera = case.scene.camera
    shift = np.array([[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]])
    port = _with_camera(case, camera.intrinsics + shift, camera.view_from_world[:3, :3])
    verdict = examine(case, {"color": port.frame.color}).verdict
    assert verdict.conventions[0].name == "a shift by half a pixel (+0.5, +0.5)"
    assert verdict.conventions[0].explains


def test_a_wrong_depth_convention_is_named() -> None:
    case = box_case()
    handed = {"color": case.frame.color[::-1].copy(), "depth": 2.0 * case.frame.depth - 1.0}
    assert examine(case, handed).verdict.outcome is Outcome.FAIL  # two mistakes at once are no single explanation


def test_a_small_bias_inside_the_bytes_is_a_fail_that_names_the_parameter(plain_referee: object) -> None:
    """Where either neighbour is legal, 0.15 % more light goes unseen pixel by pixel, but not in the mean."""
    case, port = box_case(), box_case(ambient=0.2015)
    assert abs(port.frame.color - case.frame.color).max() < 1 / 255
    for ambient_of, outcome in ((case, Outcome.PASS), (port, Outcome.FAIL)):
        for offset in (0.5, 0.0):  # the nearest, or truncated
            color = np.floor(255 * ambient_of.frame.color + offset).astype(np.uint8)
            verdict = examine(case, {"color": color}, profile="vulkan").verdict
            assert verdict.stages[0].right
            assert verdict.outcome is outcome, verdict.words()
    assert [bias.parameter for bias in verdict.biases] == ["light.ambient"]
    assert abs(verdict.biases[0].looks_like - 0.2) > verdict.biases[0].legal


def test_a_bias_that_the_tightest_finds_is_not_called_the_loosest_s(plain_referee: object) -> None:
    case, port = box_case(), box_case(ambient=0.2015)
    color = np.floor(255 * port.frame.color + 0.5).astype(np.uint8)
    verdict = examine(case, {"color": color}).verdict
    assert verdict.outcome is Outcome.FAIL
    assert verdict.biases
    assert f"judged by {verdict.profile} (the tightest)" in verdict.words()


def test_equal_colours_are_rounded_alike_and_no_bias() -> None:
    """A flat colour in bytes is off by the same everywhere: nothing to accuse a port of."""
    case = box_case()
    for profile in ("ieee32", "d3d11", "vulkan"):
        right = np.floor(255 * case.frame.color + 0.5).astype(np.uint8)
        assert examine(case, {"color": right}, profile=profile).verdict.outcome is Outcome.PASS


def test_a_wrong_parameter_is_estimated() -> None:
    case, port = box_case(), box_case(ambient=0.25)
    verdict = examine(case, {"color": port.frame.color}).verdict
    assert verdict.outcome is Outcome.FAIL
    assert verdict.biases[0].looks_like == pytest.approx(0.25, abs=1e-6)
    assert verdict.biases[0].explained > 0.99
    assert "light.ambient = 0.25 in place of 0.2" in verdict.words()


def test_what_follows_from_the_case_alone_is_drawn_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its derivatives; of a picture too large to keep them, each time, and the verdict is the same."""
    drawn: list[Case] = []
    draw = Case.draw
    monkeypatch.setattr(Case, "draw", lambda case, **how: drawn.append(case) or draw(case, **how))
    case = box_case()
    handed = {"color": np.floor(255 * case.frame.color + 0.5).astype(np.uint8)}
    first = examine(case, handed).verdict
    drawn.clear()
    assert examine(case, handed).verdict == first
    assert not drawn
    monkeypatch.setattr(bias, "_MOST_KEPT", 0)
    other = box_case()
    assert [examine(other, handed).verdict for _ in range(2)] == [first, first]
    others = [case for case in drawn if case is not other]
    assert others
    assert len(others) % 2 == 0


def test_problems_and_nothing_are_inconclusive() -> None:
    case = box_case()
    for handed, problems in (({}, ()), ({"color": case.frame.color}, ("depth.npy: is damaged",))):
        verdict = examine(case, handed, problems=problems).verdict
        assert verdict.outcome is Outcome.INCONCLUSIVE
        assert verdict.outcome.exit_code == 2
        assert "cannot be judged" in verdict.words()


def test_an_unknown_profile_is_refused() -> None:
    with pytest.raises(ValueError, match="device: found 'opengl', allowed: ieee32"):
        examine(box_case(), {}, profile="opengl")
