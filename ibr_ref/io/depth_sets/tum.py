"""TUM RGB-D (Sturm et al. 2012): lists of files and of poses, each with a time stamp.

rgb.txt and depth.txt: `TIME FILE` a line; groundtruth.txt: `TIME t_x t_y t_z q_x q_y q_z q_w`, camera to world, OpenCV's
axes. What lies nearest in time belongs together, as in the data set's own associate.py: pairs in the order of their
differences, each file and pose once. 16-bit depths of 1/5000 m, along the axis; 0 is nothing. The intrinsics are in no file
of the data set; ETH3D's of this form have `calibration.txt`, `f_x f_y c_x c_y`.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from ibr_ref.io.depth_sets.conventions import ANY, Conventions, Format, Options
from ibr_ref.io.depth_sets.text import all_numbers, finite, lines, pinhole, pose_of
from ibr_ref.io.depth_sets.view import View
from ibr_ref.io.files import naming
from ibr_ref.io.inside import file_inside
from ibr_ref.io.words import real, shown
from ibr_ref.scene import checks

_APART = 0.02
"""Seconds, as associate.py has it."""
_MOST_PAIRS = 2**22
"""That are near enough in time to be looked at."""
_INTRINSICS = (
    "f_x, f_y, c_x, c_y, pixels from the centre of the first one: this format does not have them (525, 525, 319.5, 239.5 is "
    "the sensor's default; the data set's page lists those of freiburg1, 2 and 3)"
)


class _Stamped(NamedTuple):
    """The lines of a file that begin with a time."""

    times: np.ndarray[tuple[int], np.dtype[np.float64]]
    words: list[list[bytes]]
    numbers: list[int]
    """Of the lines."""


def _holds(folder: Path) -> bool:
    return all((folder / name).exists() for name in ("rgb.txt", "depth.txt"))


def _views(folder: Path, options: Options) -> list[View]:
    apart = _APART if options.max_time_gap is None else options.max_time_gap
    intrinsics = _intrinsics(folder, options)
    color, depth, poses = (_stamped(folder / f"{name}.txt") for name in ("rgb", "depth", "groundtruth"))
    with naming(folder):
        pictures = _associated(color, depth, apart)
        taken = dict(_associated(_chosen(color, [i for i, _ in pictures]), poses, apart))
    result = []
    for k, (i, j) in enumerate(pictures):
        if k not in taken:
            continue
        line = poses.numbers[taken[k]]
        with naming(folder / "groundtruth.txt"):
            t_x, t_y, t_z, *quaternion = finite(poses.words[taken[k]], 7, f"line {line}")
            pose = pose_of(quaternion, [t_x, t_y, t_z])
        picture, map_ = _file(folder, "rgb.txt", color, i), _file(folder, "depth.txt", depth, j)
        where = f"{folder / 'groundtruth.txt'}: line {line}"
        result.append(View(str(picture.relative_to(folder)), where, picture, map_, intrinsics, pose))
    if not result:
        found = f"{len(color.times)} pictures, {len(depth.times)} depth maps and {len(poses.times)} poses"
        raise ValueError(
            f"{checks.named(folder)}: found {found}, allowed: at least one of each, within max_time_gap = {apart:g}"
        )
    return result


def _intrinsics(folder: Path, options: Options) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    path = folder / "calibration.txt"
    if options.intrinsics is not None:
        return pinhole(*options.intrinsics)
    if not path.exists():
        raise ValueError(
            f"{checks.named(folder)}: intrinsics: found None and no calibration.txt, allowed: {_INTRINSICS}"
        )
    values = all_numbers(path)
    if len(values) < 4 or any(values[4:]):
        allowed = "f_x f_y c_x c_y, and no distortion: pictures without it"
        raise ValueError(f"{checks.named(path)}: found {values[:12]}, allowed: {allowed}")
    return pinhole(*values[:4])


def _stamped(path: Path) -> _Stamped:
    times, words, numbers = list[float](), list[list[bytes]](), list[int]()
    with naming(path):
        for number, line in lines(path):
            try:
                times.append(checks.number("time", real(line[0])))
            except ValueError:
                raise ValueError(
                    f"line {number}: found {shown(line)}, allowed: a time and what belongs to it"
                ) from None
            words.append(line[1:])
            numbers.append(number)
    return _Stamped(np.array(times, np.float64), words, numbers)


def _chosen(stamped: _Stamped, indices: list[int]) -> _Stamped:
    return _Stamped(stamped.times[indices], [stamped.words[i] for i in indices], [stamped.numbers[i] for i in indices])


def _file(folder: Path, list_: str, stamped: _Stamped, index: int) -> Path:
    with naming(folder / list_):
        if not stamped.words[index]:
            raise ValueError(f"line {stamped.numbers[index]}: found no file, allowed: a time and a file")
        name = b" ".join(stamped.words[index]).decode("utf-8", "replace")
        return file_inside(f"line {stamped.numbers[index]}", folder, name)


def _associated(first: _Stamped, second: _Stamped, apart: float) -> list[tuple[int, int]]:
    """Pairs of indices, each index once, the nearest in time first taken; in the order of the first ones' times."""
    order = np.argsort(second.times, kind="stable")
    times = second.times[order]
    low = np.searchsorted(times, first.times - apart, "left")
    count = np.searchsorted(times, first.times + apart, "right") - low
    total = int(count.sum())
    if total > _MOST_PAIRS:
        raise checks.reject("max_time_gap", apart, f"a time within which at most {_MOST_PAIRS} pairs lie")
    i = np.repeat(np.arange(len(first.times)), count)
    j = order[np.arange(total) - np.repeat(np.cumsum(count) - count, count) + np.repeat(low, count)]
    nearest = np.lexsort((j, i, np.abs(first.times[i] - second.times[j])))
    used_first, used_second, pairs = set[int](), set[int](), list[tuple[int, int]]()
    for a, b in zip(i[nearest].tolist(), j[nearest].tolist(), strict=True):
        if a not in used_first and b not in used_second:
            used_first.add(a)
            used_second.add(b)
            pairs.append((a, b))
    return sorted(pairs, key=lambda pair: (first.times[pair[0]], pair))


FORMAT = Format(
    "tum",
    "rgb.txt, depth.txt and groundtruth.txt",
    _holds,
    _views,
    Conventions("opencv", "camera_to_world", "axis", "integer", depth_scale=1.0 / 5000.0),
    (*ANY, "intrinsics", "max_time_gap"),
)
