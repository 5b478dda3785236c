"""Mistakes of conventions that turn a right image into a wrong one: each undone in turn, and judged again."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.colors import as_numbers
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.findings import Convention
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.referees import referee
from ibr_ref.scene import Camera

Image = NDArray[np.generic]


@dataclass(frozen=True, eq=False)
class _Guess:
    """What the port may have done: the case that it then drew, and its image with that undone."""

    name: str
    case: Case
    handed: Handed


def conventions(case: Case, device: Device, handed: Handed, wrong: int) -> tuple[Convention, ...]:
    """Try each; those that bring the image nearer to the reference are judged, the best first.

    A guess that does not halve the mean difference is not worth a judgement: it could not explain nine of ten pixels.
    """
    before = _distance(case, handed)
    found = []
    for guess in _guesses(case, handed):
        if _distance(guess.case, guess.handed) > 0.5 * before:
            continue
        judgement = referee(case.method).judge_image(guess.case, device, guess.handed)
        left = int(judgement.wrong.sum())
        found.append(Convention(name=guess.name, wrong=left, explains=left < 0.1 * wrong))
    return tuple(sorted(found, key=lambda convention: convention.wrong))


def _distance(case: Case, handed: Handed) -> float:
    """Mean absolute difference of colours and, where handed in, depths."""
    color = as_numbers(handed["color"])
    distance = float(np.nanmean(np.abs(color - case.frame.color)))
    if "depth" in handed:
        distance += float(np.nanmean(np.abs(as_numbers(handed["depth"]) - case.frame.depth)))
    return distance


def _guesses(case: Case, handed: Handed) -> Iterator[_Guess]:
    for name, undo in _ON_IMAGES.items():
        yield _Guess(name, case, {k: undo(np.asarray(handed[k])) for k in ("color", "depth") if k in handed})
    yield _Guess("channels in the order BGR", case, {**handed, "color": np.asarray(handed["color"])[..., ::-1]})
    yield _Guess("colours encoded as sRGB", case, {**handed, "color": _linear(as_numbers(handed["color"]), handed)})
    yield _Guess(
        "colours decoded from sRGB once too often",
        case,
        {**handed, "color": _encoded(as_numbers(handed["color"]), handed)},
    )
    if "depth" in handed:
        depth = as_numbers(handed["depth"])
        yield _Guess("depth as z in [-1, 1]", case, {**handed, "depth": depth / 2.0 + 0.5})
        yield _Guess("reversed depth", case, {**handed, "depth": 1.0 - depth})
    yield from _on_cameras(case, handed)


_ON_IMAGES: dict[str, Callable[[Image], Image]] = {
    "rows from the bottom up": lambda image: image[::-1],
    "columns from right to left": lambda image: image[:, ::-1],
    "rows and columns exchanged": lambda image: np.swapaxes(image, 0, 1) if image.shape[0] == image.shape[1] else image,
    "a shift by one row": lambda image: np.roll(image, -1, 0),
    "a shift by one row up": lambda image: np.roll(image, 1, 0),
    "a shift by one column": lambda image: np.roll(image, -1, 1),
    "a shift by one column to the left": lambda image: np.roll(image, 1, 1),
}


def _on_cameras(case: Case, handed: Handed) -> Iterator[_Guess]:
    """Other cameras that the port may have had; only of perspective ones."""
    camera = case.scene.camera
    if not camera.perspective:
        return
    for dx, dy in ((-0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (0.5, -0.5)):
        shift = np.array([[0.0, 0.0, dx], [0.0, 0.0, dy], [0.0, 0.0, 0.0]])
        name = f"a shift by half a pixel ({dx:+g}, {dy:+g})"
        yield _Guess(name, _with_camera(case, camera.intrinsics + shift, camera.view_from_world[:3, :3]), handed)
    transposed = _with_camera(case, camera.intrinsics, camera.view_from_world[:3, :3].T)
    yield _Guess("a transposed view matrix", transposed, handed)


def _with_camera(case: Case, intrinsics: NDArray[np.float64], rotation: NDArray[np.float64]) -> Case:
    camera = case.scene.camera
    other = Camera.calibrated(
        intrinsics=intrinsics,
        rotation=rotation,
        translation=camera.view_from_world[:3, 3],
        near=camera.near,
        far=camera.far,
        width=camera.width,
        height=camera.height,
    )
    return replace(case, scene=replace(case.scene, camera=other))


def _linear(color: NDArray[np.float64], handed: Handed) -> Image:
    """IEC 61966-2-1: encoded to linear."""
    c = np.clip(color, 0.0, 1.0)
    # The standard's own constants.
    return _as_handed(np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4), handed)


def _encoded(color: NDArray[np.float64], handed: Handed) -> Image:
    """IEC 61966-2-1: linear to encoded."""
    c = np.clip(color, 0.0, 1.0)
    # The standard's own constants.
    return _as_handed(np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1.0 / 2.4) - 0.055), handed)


def _as_handed(color: NDArray[np.float64], handed: Handed) -> Image:
    """Bytes again where bytes were handed in."""
    if np.asarray(handed["color"]).dtype == np.uint8:
        return color_bytes(color)
    return color
