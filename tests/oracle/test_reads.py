"""Every stage is judged on the port's own arrays: for each of them, what is made of another one is right for that one.

A port whose array is changed between two stages is wrong in that array alone; one that hands in a changed array and goes on
with another is wrong after it. Changed by what is legal, it is right all through.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

from ibr_ref import methods
from ibr_ref.oracle.cases import Case, build
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.referees.reads import fed, reads_of
from ibr_ref.oracle.trials import judge
from tests.oracle.tampered import Arrays, tampered

CASES = {
    "displacement": ["displacement-tiles"],
    "splatting": ["splatting-lamp"],
    "splatting, ellipses": ["splatting-ellipses"],
    "shadows": ["shadows-pace", "shadows-penumbra"],
}
"""Of each method, and of what has a table of its own, those that together have all arrays.

An array is changed in the first that has it.
"""


def _moved(by: float) -> Callable[[Any], Any]:
    return lambda array: array + by


def _clip(clip: Any) -> Any:
    return clip + 0.01 * clip[..., 3:] * np.array([1.0, 0.0, 0.0, 0.0])


def _codes(codes: Any) -> Any:
    """Other normals, where there are any."""
    return np.where((codes > 0).any(axis=-1, keepdims=True), np.clip(codes.astype(int) ^ 9, 1, 255), 0).astype(np.uint8)


def _rects(rects: Any) -> Any:
    """The second image's texels from a column to the left."""
    result = rects.copy()
    result[1, 1] -= 1
    return result


def _winners(splats: Any) -> Any:
    """The point before."""
    return np.where(splats > 0, splats - 1, splats)


def _turned(normals: Any) -> Any:
    return normals[..., [1, 0, 2]]


def _inner(grids: Any) -> Any:
    """Points inside the grid moved a little, its border left."""
    result = np.array(grids)
    result[..., 2, 2, :] += 0.004
    return result


WRONG: dict[str, Callable[[Any], Any]] = {
    "atlas.rects": _rects,
    "atlas.color": lambda pages: np.where(pages > 0.0, 1.0 - pages, 0.0),
    "atlas.depth": lambda pages: pages * 1.01,
    "atlas.normal": _codes,
    "vertex.window": _moved(0.75),
    "vertex.depth": lambda depth: depth * 0.999,
    "vertex.width": lambda width: width + np.where(width > 0.0, 0.5, 0.0),
    "vertex.color": lambda color: 0.5 * color,
    "vertex.covariance": lambda covariance: covariance * np.array([1.2, 0.9, 0.8]),
    "vertex.amplitude": lambda amplitude: 0.8 * amplitude + np.linspace(0.0, 0.2, len(amplitude)),
    "vertex.distance": lambda distance: distance * np.linspace(1.0, 1.1, len(distance)),
    "raster.splat": _winners,
    "raster.depth": lambda depth: np.where(depth < 1.0, 0.9 * depth, 1.0),
    "raster.weight": lambda weight: 0.9 * weight,
    "vertex.clip": _clip,
    "vertex.patch": lambda patch: patch * np.array([0.98, 1.0, 1.0]),
    "raster.patch": lambda patch: patch * np.array([0.97, 1.0, 1.0]),
    "march.hit": lambda hit: hit * np.array([0.95, 1.0, 1.0]),
    "march.steep": np.logical_not,
    "shade.albedo": lambda albedo: 1.0 - albedo,
    "shade.normal": _turned,
    "shade.lit": np.logical_not,
    "maps.positions": lambda positions: positions * 1.01,
    "maps.depths": lambda depths: depths * np.linspace(1.0, 1.1, 3),
    "maps.image": lambda image: 0.5 * image,
    "controls": _inner,
    "warp.cell": lambda cell: 1 - cell,
    "warp.fraction": lambda fraction: 0.9 * fraction,
    "warp.shares": lambda shares: 0.9 * shares,
    "warp.row_grids": _inner,
    "warp.rows": lambda rows: 0.5 * rows,
    "warp.grid": _inner,
    "warp.image": lambda image: 0.5 * image,
    "project.coord": lambda coord: coord * np.array([0.9, 1.0, 1.0]),
    "project.blocker": lambda blocker: 0.9 * blocker,
    "project.penumbra": lambda scale: 0.8 * scale,
    "project.shadow": lambda shadow: 0.5 * shadow,
    "accumulate.shadow": lambda shadow: 0.5 * shadow,
}
"""What is wrong in every way that a device has."""

NO_CHANGE = {"raster.patch_id", "raster.face", "march.hit_index", "depth"}
"""Which polygon and face, and that nothing was hit: changed alone they say of other pixels what was computed there."""

OF = {**{method: (method, "") for method in methods.names()}, "splatting, ellipses": ("splatting", "ellipse")}
READS = {method: reads_of(*of) for method, of in OF.items()}
READ = {m: sorted({n for reads in READS[m].values() for n in reads}) for m in READS}
PAIRS = [(m, n) for m in READ for n in READ[m] if n not in NO_CHANGE]


@cache
def case(name: str) -> Case:
    return build(name)


@cache
def plain(name: str) -> Arrays:
    return tampered(case(name), "", lambda array: array)


def case_with(method: str, array: str) -> str:
    """The name of the first case that has it."""
    return next(name for name in CASES[method] if array in plain(name))


def blamed(name: str, arrays: Arrays) -> dict[str, int]:
    """How many elements, by the array that is wrong there; of the stages."""
    found: dict[str, int] = {}
    for j in judge(case(name), arrays, PROFILES["ieee32"]):
        if j.stage != "image":
            for array, count in zip(j.arrays, np.bincount(j.blame[j.wrong].clip(0), minlength=99), strict=False):
                if count:
                    found[array] = found.get(array, 0) + int(count)
    return found


def test_every_array_that_is_read_is_tried() -> None:
    assert {n for _, n in PAIRS} == {*WRONG}
    for method, reads in READS.items():
        of_cases = [n for name in CASES[method] for n in plain(name)]
        names = {n.rpartition(".")[0] if n[-1].isdigit() else n for n in of_cases} | {"color", "depth"}
        assert names == {*reads} | {"color", "depth"}, method


@pytest.mark.parametrize("name", [name for names in CASES.values() for name in names])
def test_the_plain_port_is_right(name: str) -> None:
    assert blamed(name, plain(name)) == {}


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("method", "name"), PAIRS)
def test_what_reads_an_array_follows_it(method: str, name: str) -> None:
    of = case_with(method, name)
    found = blamed(of, tampered(case(of), name, WRONG[name]))
    assert name in found
    readers = {array for array, reads in READS[method].items() if name in reads}
    assert not readers & {*found}, "judged on something else than what was handed in"
    assert {*found} == {name}


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("method", "name"), PAIRS)
def test_what_does_not_follow_an_array_is_wrong(method: str, name: str) -> None:
    of = case_with(method, name)
    changed = tampered(case(of), name, WRONG[name])[name]
    found = blamed(of, plain(of) | {name: changed})
    if name in ("maps.image", "atlas.normal"):
        assert {*found} == {name}, "with these a port need not go on: the case hands them over"
    elif name == "maps.positions":
        assert {*found} == {name, "maps.image"}, "nor with these, but its own maps are of them"
    elif name in ("project.coord", "project.blocker", "project.penumbra") or name.startswith("shade."):
        assert {*found} == {name}, "one judgement for both: the array before is blamed"
    else:
        assert {*found} - {name}


@pytest.mark.parametrize(("method", "name"), PAIRS)
def test_a_rounding_is_legal_all_through(method: str, name: str) -> None:
    """The port computed with more digits than it handed in: the next float32 beside each number may as well be there."""
    of = case_with(method, name)
    array = plain(of)[name]
    if np.asarray(array[0] if isinstance(array, tuple) else array).dtype.kind != "f":
        pytest.skip("no float")
    random = np.random.default_rng(7)

    def stored(page: Any) -> Any:
        return page * (1.0 + 2.0**-24 * random.uniform(-0.99, 0.99, page.shape))

    changed = tuple(map(stored, array)) if isinstance(array, tuple) else stored(np.asarray(array))
    assert {*blamed(of, plain(of) | {name: changed})} <= {name}


@pytest.mark.parametrize("method", READS)
def test_what_is_missing_is_read_through(method: str) -> None:
    for name, reads in READS[method].items():
        kind, system = OF[method]
        assert fed(kind, [name], READS[method], system) == tuple(n for n in READS[method] if n in reads)
        assert fed(kind, [name], [], system) == ()
    if method == "splatting":
        assert fed(method, ["raster.splat"], ["atlas.depth"]) == ("atlas.depth",)
        assert fed(method, ["color"], ["atlas.normal", "raster.splat"]) == ("atlas.normal", "raster.splat")


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("name", ["splatting-ball", "splatting-shelves"])
def test_a_texel_is_fetched_once_more(name: str, profile: str) -> None:
    """Each fetch of a byte is a quotient: the colour of a point may be another one than that of the atlas."""
    described = build(name)
    arrays: Arrays = {**described.frame.stages}
    up = np.nextafter(arrays["vertex.color"].astype(np.float32), np.float32(2.0)).astype(np.float64)
    for handed in ({"vertex.color": up}, {"vertex.color": up, "atlas.color": arrays["atlas.color"]}):
        assert not any(j.wrong.any() for j in judge(described, handed, PROFILES[profile]))
