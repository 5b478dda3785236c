"""What a picture, or a film, is drawn in: frames, and bands of rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ibr_ref.io.frame import Frame

Rows = tuple[int, int]
"""First and one past the last."""


class Part(NamedTuple):
    """A scene as some camera sees it, None: its own; all of the picture, or some rows."""

    camera: Any = None
    rows: Rows | None = None


class Drawn(NamedTuple):
    """What came of it."""

    color: NDArray[np.float64]
    """(rows, width, 3)."""
    shown: bool
    """Whether anything but the background is there."""


Draw = Callable[[Iterable[Part]], Iterator[Drawn]]
"""Draws parts, in their order."""


def drawn(scene: Any, render: Callable[..., Any], part: Part) -> Drawn:
    """Draw a part of a scene; render(scene, rows=...) gives a frame."""
    scene = scene if part.camera is None else replace(scene, camera=part.camera)
    frame = render(scene) if part.rows is None else render(scene, rows=part.rows)
    return Drawn(frame.color, shows(frame))


def shows(frame: Frame) -> bool:
    """Whether anything but the background is there."""
    return bool((frame.depth < 1.0).any())
