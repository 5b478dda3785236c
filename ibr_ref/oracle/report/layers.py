"""The pictures of a report: reference and port, where they differ, what is undecided, what is wrong."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ibr_ref.array_types import Bytes
from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.examination import Examination
from ibr_ref.oracle.judgement import Judgement

AMBER, RED = (255, 176, 0), (255, 32, 64)


@dataclass(frozen=True)
class Layer:
    """A picture of the case's size, with what it shows in words."""

    name: str
    title: str
    source: str
    """A data: address."""


def layers(examination: Examination) -> list[Layer]:
    """Of the final picture; port, difference and marks only where a colour was handed in and judged."""
    reference = _bytes(examination.case.frame.color)
    found = [Layer("reference", "reference", address(reference))]
    color, image = examination.handed.get("color"), examination.judgement("image")
    if color is None or image is None:
        return found
    port = _bytes(np.asarray(color))
    difference = np.abs(reference.astype(int) - port.astype(int))
    gain = 255 // max(int(difference.max()), 1)
    marks = _dimmed(reference)
    marks[image.undecided], marks[image.wrong] = AMBER, RED
    return [
        *found,
        Layer("port", "port", address(port)),
        Layer("difference", f"difference, {gain} times", address((difference * gain).astype(np.uint8))),
        Layer("marks", "wrong pixels red, undecided ones amber", address(marks)),
    ]


def stage_layer(judgement: Judgement) -> Layer | None:
    """Where a stage is wrong, for stages whose elements lie in two dimensions (the last two of more)."""
    if judgement.wrong.ndim < 2:
        return None
    wrong, undecided = (a.reshape(-1, a.shape[-1]) for a in (judgement.wrong, judgement.undecided))
    picture = np.full((*wrong.shape, 3), 24, np.uint8)
    picture[undecided], picture[wrong] = AMBER, RED
    return Layer(judgement.stage, f"{judgement.stage}: wrong red, undecided amber", address(picture))


def address(picture: Bytes) -> str:
    """A PNG as a data: address."""
    buffer = io.BytesIO()
    Image.fromarray(picture).save(buffer, "png")
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")


def planes(examination: Examination) -> Mapping[str, tuple[NDArray[np.generic] | None, NDArray[np.generic] | None]]:
    """What the inspector shows of each pixel: (reference, port) by array, (H, W) or (H, W, k), k <= 4."""
    case, handed = examination.case, examination.handed
    size = case.frame.color.shape[:2]
    ours = {"color": case.frame.color, "depth": case.frame.depth, **case.frame.stages}
    found = {}
    for name, reference in ours.items():
        if isinstance(reference, tuple) or reference.shape[:2] != size or reference[0, 0].size > 4:
            continue
        port = handed.get(name)
        if port is not None and np.asarray(port).dtype == np.uint8:
            port = np.asarray(port) / 255.0
        found[name] = (reference, None if port is None else np.asarray(port))
    return found


def blamed(examination: Examination, array: str) -> NDArray[np.bool_] | None:
    """(H, W) where the array is the first in which a wrong stage, or the picture, disagrees; None: nowhere."""
    result = np.zeros(examination.case.frame.color.shape[:2], np.bool_)
    for judgement in examination.judgements:
        if judgement.wrong.shape == result.shape and array in judgement.arrays:
            result |= judgement.wrong & (judgement.blame == judgement.arrays.index(array))
    return result if result.any() else None


def _bytes(color: NDArray[np.generic]) -> Bytes:
    if color.dtype == np.uint8:
        return np.asarray(color, np.uint8)
    shown = np.nan_to_num(color.astype(np.float64), nan=0.0, posinf=1.0, neginf=0.0)
    return color_bytes(shown)


def _dimmed(picture: Bytes) -> Bytes:
    """Grey and dark, so that marks stand out."""
    grey = picture.mean(axis=-1) * 0.45 + 16.0
    return np.repeat(grey[..., None], 3, axis=-1).astype(np.uint8)
