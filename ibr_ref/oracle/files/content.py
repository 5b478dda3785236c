"""Whether there is anything to judge: images that hold no numbers, that nothing was drawn into, or that are another case's.

Nothing here can clear a port, and only numbers that are none keep one from being judged. Where nothing was drawn that may be
right, as where all that is there may legally be clipped: `empty` and `stale` are asked of a wrong submission, and turn FAIL
into INCONCLUSIVE, with the likelier reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bytes
from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.files.problem import Problem
from ibr_ref.oracle.schema.stages import flat

BYTES_AS_FLOATS = 16.0
"""A colour above it was not meant to be in [0, 1]; lit too brightly, an unclamped one stays below."""
STALE_STEP = 2
"""Steps of 1/255 by which a port's image may differ from the one that it is."""
STALE_OWN = 0.02
"""Share of the pixels that must differ by more from the image that was asked for, and ..."""
STALE_RATIO = 10.0
"""... how many times more than from the other case's, for the image to be the other case's."""


def content_problems(case: Case, handed: Mapping[str, Any], files: Mapping[str, str]) -> list[Problem]:
    """Why arrays of the right types and shapes cannot be judged; files: where each came from, for the words."""
    if not set(handed) - {"depth"}:
        return [
            Problem("submission", "neither a final image nor a stage", "color.png, color.npy, or any stage's array")
        ]
    problems = []
    for name in ("color", "depth"):
        if name in handed:
            problems += _number_problems(files.get(name, name), handed[name])
    return problems


def empty(case: Case, handed: Mapping[str, Any], files: Mapping[str, str]) -> list[Problem]:
    """Images of one colour and stages without a number, where the reference has more."""
    problems = _blank(case, as_bytes(handed["color"]), files.get("color", "color")) if "color" in handed else []
    stages = {name: array for name, array in handed.items() if name in case.frame.stages}
    references = flat(case.frame.stages)
    for name, array in flat(stages).items():
        problems += _empty_stage(files.get(name, name), array, references[name])
    return problems


def as_bytes(color: NDArray[Any]) -> Bytes:
    """A handed colour in 8 bits."""
    return color if color.dtype == np.uint8 else color_bytes(color)


def _number_problems(file: str, array: NDArray[Any]) -> list[Problem]:
    if array.dtype.kind != "f" or not array.size:
        return []
    bad = ~np.isfinite(array)
    if bad.any():
        where = np.argwhere(bad)[0].tolist()
        found = f"{array[bad][0]} at {where}, and {int(bad.sum())} in all"
        return [Problem(file, found, "finite numbers in the final image and its depth")]
    if array.max() > BYTES_AS_FLOATS:
        found = f"numbers up to {array.max():g}"
        return [Problem(file, found, "[0, 1]; bytes as uint8, not as floats")]
    return []


def _blank(case: Case, image: Bytes, file: str) -> list[Problem]:
    """An image of one colour where the case has more."""
    color = image[0, 0]
    if (image != color).any() or not (np.diff(color_bytes(case.frame.color).reshape(-1, 3), axis=0) != 0).any():
        return []
    background = color_bytes(np.asarray(case.scene.background, np.float64))
    what = "the background" if (color == background).all() else "black" if not color.any() else "one colour"
    found = f"nothing rendered: all pixels are {what}, {color.tolist()}"
    return [Problem(file, found, "a picture; the case's has more than one colour")]


def _empty_stage(file: str, array: NDArray[Any], reference: NDArray[Any]) -> list[Problem]:
    """A stage without a number where the reference has some."""
    if array.dtype.kind != "f" or not array.size or not np.isnan(array).all() or np.isnan(reference).all():
        return []
    return [Problem(file, "NaN alone: nothing rendered", "numbers where the reference has some")]


def stale(case: Case, handed: Mapping[str, Any], others: Iterable[tuple[str, NDArray[np.float64]]]) -> Problem | None:
    """Whether an image that is wrong for its case is another case's, of `others` by name; none where it is not.

    To be asked only of a submission whose image was found wrong: the thresholds are a matter of judgement, and two cases
    may look alike.
    """
    if "color" not in handed:
        return None
    image = as_bytes(handed["color"])
    own = _differing(image, color_bytes(case.frame.color))
    for name, color in others:
        if name == case.name or color.shape != image.shape or own < STALE_OWN:
            continue
        if _differing(image, color_bytes(color)) * STALE_RATIO <= own:
            found = f"the image of another case, {name!r}"
            return Problem("color", found, f"that of {case.name!r}")
    return None


def _differing(a: Bytes, b: Bytes) -> float:
    """Share of the pixels that differ by more than `STALE_STEP`."""
    return float((np.abs(a.astype(np.int16) - b).max(axis=2) > STALE_STEP).mean())
