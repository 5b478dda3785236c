"""The referee sees: what no legal device shows is wrong, by the picture, by picture and depth, and with stages."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from ibr_ref.oracle.device import LOOSEST, PROFILES
from ibr_ref.oracle.examination import examine
from ibr_ref.oracle.findings import Outcome
from tests.oracle.displacement.drawn import REFEREE, Arrays, case, reference


def hits(name: str) -> np.ndarray:
    return reference(name)["march.hit_index"] >= 0


def accepted(name: str, profile: str, **changed: np.ndarray) -> int:
    """Hit pixels that are called right."""
    arrays = reference(name)
    handed = {"color": arrays["color"], **changed}
    judgement = REFEREE.judge_image(case(name), PROFILES[profile], handed)
    return int((~judgement.wrong & hits(name)).sum())


def painted(name: str, color: np.ndarray) -> np.ndarray:
    picture = reference(name)["color"].copy()
    picture[hits(name)] = color
    return picture


@pytest.mark.parametrize(
    ("name", "profile"),
    [
        ("displacement-city", "d3d11"),
        ("displacement-slope", "vulkan"),
        ("displacement-tiles", "gl"),
        ("displacement-crossing", "d3d11"),
    ],
)
def test_a_random_colour_is_wrong(name: str, profile: str) -> None:
    count = int(hits(name).sum())
    random = painted(name, np.random.default_rng(1).random((count, 3)))
    assert accepted(name, profile, color=random) <= 0.01 * count


@pytest.mark.long
def test_the_magenta_city_fails_by_every_profile() -> None:
    """194 pixels of a small picture of it; undeclared, as the tightest device that explains it is sought."""
    city = case("displacement-city")
    small = replace(
        city, scene=replace(city.scene, camera=replace(city.scene.camera, width=56, height=42, intrinsics=None))
    )
    rows, columns = np.nonzero(small.frame.depth < 1.0)
    color = small.frame.color.copy()
    color[rows[:194], columns[:194]] = (1.0, 0.0, 1.0)
    verdict = examine(small, {"color": color}, name_causes=False).verdict
    assert verdict.outcome is Outcome.FAIL
    assert verdict.stages[-1].wrong > 0.97 * 194
    assert not REFEREE.judge_image(small, PROFILES["ieee32"], {"color": color}).wrong.sum() < 194
    assert verdict.profile == LOOSEST, "what the loosest does not explain no tighter one does"


def moved_depth(name: str, by: float) -> np.ndarray:
    depth = reference(name)["depth"].copy()
    depth[hits(name)] += by
    return depth


@pytest.mark.parametrize(
    ("name", "profile"),
    [("displacement-city", "gl"), ("displacement-slope", "d3d11"), ("displacement-crossing", "vulkan")],
)
def test_a_depth_bias_is_wrong(name: str, profile: str) -> None:
    assert accepted(name, profile, depth=moved_depth(name, 3e-4)) <= 0.005 * hits(name).sum()


def test_a_depth_of_twelve_bits_is_wrong() -> None:
    name = "displacement-slope"
    coarse = np.floor(reference(name)["depth"] * 4095.0 + 0.5) / 4095.0
    assert accepted(name, "d3d11", depth=coarse) < 0.5 * hits(name).sum()


@cache
def swapped(name: str) -> tuple[Arrays, np.ndarray]:
    """The picture of the scene with its polygons' order of depth the wrong way round, where both are hit."""
    what = case(name)
    alone = []
    for polygon in what.scene.polygons:
        alone.append(replace(what, scene=replace(what.scene, polygons=[polygon])).frame)
    first, second = alone
    both = (first.depth < 1.0) & (second.depth < 1.0) & (np.abs(first.depth - second.depth) < 0.01)
    farther = np.where(first.depth > second.depth, 0, 1)
    rows, columns = np.nonzero(both)
    some = slice(0, len(rows), max(1, len(rows) // 45))
    rows, columns = rows[some], columns[some]
    color, depth = reference(name)["color"].copy(), reference(name)["depth"].copy()
    for row, column in zip(rows, columns, strict=True):
        loser = alone[farther[row, column]]
        color[row, column], depth[row, column] = loser.color[row, column], loser.depth[row, column]
    return {"color": color, "depth": depth}, np.array([rows, columns])


@pytest.mark.parametrize("profile", ["d3d11", "gl"])
def test_wrong_winners_of_a_depth_test_are_wrong(profile: str) -> None:
    arrays, where = swapped("displacement-crossing")
    assert len(where[0]) >= 45
    judgement = REFEREE.judge_image(case("displacement-crossing"), PROFILES[profile], arrays)
    assert judgement.wrong[tuple(where)].mean() > 0.9
