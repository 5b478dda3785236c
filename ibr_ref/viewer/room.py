"""What a page needs to know of a method: the record that each has, `viewer/<method>.py`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ibr_ref.array_types import Floats
from ibr_ref.scene.limits import Limit
from ibr_ref.viewer.knobs import Knob, OneOf


@dataclass(frozen=True, kw_only=True)
class Viewable:
    """A method as pages show it."""

    limits: Mapping[str, Limit | OneOf]
    """Of the fields of its `Params` that have sliders."""
    read_by: Mapping[str, tuple[str, ...]]
    """Fields that only some systems read, and these."""
    points: Callable[[Any, Any], Floats]
    """(N, 3) in world space around what a scene with these parameters shows: near and far planes follow them."""
    knobs: Callable[[Any], dict[str, Knob]]
    """Of a scene."""
    changed: Callable[[Any, Mapping[str, Any]], Any]
    """The scene with these knobs turned."""
    truth: Mapping[str, Any] = field(default_factory=dict)
    """Fields of `Params` with which the picture is what the method approximates; none: nothing is known to be nearer."""
    prepared: Callable[[Any, Any, Mapping[str, Any]], Mapping[str, Any]] | None = None
    """What `render` is given besides scene and parameters: made anew where what was given does not fit them."""
