"""Stage resolve: the colour of a fragment in a shadow."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.referees.shadows.model import Model
from ibr_ref.oracle.referees.shadows.surface import Seen


def colors(model: Model, seen: Seen, fragment: Ints, turned: Bools, shadow: Bounded) -> list[Bounded]:
    """Three channels (n,) of fragments by their index, in a shadow (n,); turned: on the side that the eye may be on too."""
    cosine = seen.other[fragment].where(turned, seen.cosine[fragment])
    surface = model.numbers([*(channel[fragment] for channel in seen.color), cosine, shadow])
    with np.errstate(all="ignore"):
        return _written(model, model.program.shaded(surface[:3], surface[4], surface[3]))


def _written(model: Model, channels: Any) -> list[Bounded]:
    color = model.program.written(np.stack(channels, axis=-1))
    return [model.bounded(color[..., k]) for k in range(3)]


def as_read(model: Model, seen: Seen, picture: NDArray[Any]) -> NDArray[Any]:
    """(H W, 3) a port's picture, each pixel where the program writes it."""
    source = model.program.turned_rows(np.arange(len(seen.empty)).reshape(seen.shape)).reshape(-1)
    found = np.empty_like(picture.reshape(-1, 3))
    found[source] = picture.reshape(-1, 3)
    return found


def allows(color: list[Bounded], found: NDArray[np.generic]) -> Bools:
    """Whether a port's colours (n, 3) are legal."""
    legal = [allows_color(channel, found[..., k]) for k, channel in enumerate(color)]
    return np.asarray(legal[0] & legal[1] & legal[2])


def background(model: Model) -> list[Bounded]:
    """Three channels (1,)."""
    return _written(model, [channel.reshape(1) for channel in model.program.background()])


def allows_nothing(model: Model, seen: Seen, color: NDArray[Any] | None, depth: NDArray[Any] | None) -> Bools:
    """(H W,) whether a port's pixel shows nothing: the background, and depth 1. color (H W, 3): as it is read."""
    legal = np.ones(len(seen.empty), np.bool_)
    if color is not None:
        legal &= allows(background(model), color)
    if depth is not None:
        legal &= np.asarray(depth.reshape(-1) == 1.0)
    return legal
