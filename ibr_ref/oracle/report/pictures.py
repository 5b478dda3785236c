"""The pictures of a report, as small as they get: the page makes differences, marks and gains of them."""

from __future__ import annotations

import base64
import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ibr_ref.array_types import Bytes
from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.examination import Examination
from ibr_ref.oracle.judgement import Judgement

AMBER, RED = (255, 176, 0), (255, 32, 64)


def reference(examination: Examination) -> Bytes:
    """(H, W, 3) of the final picture."""
    return shown(examination.case.frame.color)


def port(examination: Examination) -> Bytes | None:
    """Likewise, where a colour was handed in and judged."""
    color = examination.handed.get("color")
    return None if color is None or examination.judgement("image") is None else shown(np.asarray(color))


def status(examination: Examination) -> Bytes | None:
    """(H, W): bit 0 where the picture is undecided, bit 1 where it is wrong."""
    image = examination.judgement("image")
    return None if image is None else (image.undecided + 2 * image.wrong).astype(np.uint8)


def stage_address(judgement: Judgement) -> str | None:
    """Where a stage is wrong, for stages whose elements lie in two dimensions (the last two of more)."""
    if judgement.wrong.ndim < 2:
        return None
    wrong, undecided = (a.reshape(-1, a.shape[-1]) for a in (judgement.wrong, judgement.undecided))
    picture = np.full((*wrong.shape, 3), 24, np.uint8)
    picture[undecided], picture[wrong] = AMBER, RED
    return address(picture)


def address(picture: Bytes) -> str:
    """A PNG as a data: address."""
    buffer = io.BytesIO()
    Image.fromarray(picture).save(buffer, "png", optimize=True)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")


def shown(color: NDArray[np.generic]) -> Bytes:
    """Bytes of a picture that may hold anything."""
    if color.dtype == np.uint8:
        return np.asarray(color, np.uint8)
    return color_bytes(np.nan_to_num(color.astype(np.float64), nan=0.0, posinf=1.0, neginf=0.0))
