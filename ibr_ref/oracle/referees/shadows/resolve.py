"""Stage resolve: the colour of a fragment in a shadow."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.accept.bounded import Bounded, exact, uploaded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.referees.shadows.surface import Seen


def colors(scene: Any, seen: Seen, fragment: Ints, turned: Bools, shadow: Bounded) -> list[Bounded]:
    """Three channels (n,) of fragments by their index, in a shadow (n,); turned: on the side that the eye may be on too."""
    device = shadow.device
    ambient, one = uploaded(float(scene.ambient), device), exact(1.0, device)
    cosine = seen.other[fragment].where(turned, seen.cosine[fragment])
    bright = ambient + (one - ambient) * (one - shadow) * cosine
    return [channel[fragment] * bright for channel in seen.color]


def allows(color: list[Bounded], found: NDArray[np.generic]) -> Bools:
    """Whether a port's colours (n, 3) are legal."""
    legal = [allows_color(channel, found[..., k]) for k, channel in enumerate(color)]
    return np.asarray(legal[0] & legal[1] & legal[2])


def background(scene: Any, seen: Seen) -> list[Bounded]:
    """Three channels (1,)."""
    return [uploaded(np.array([c]), seen.depth.device) for c in np.asarray(scene.background, np.float64)]


def allows_nothing(scene: Any, seen: Seen, color: NDArray[Any] | None, depth: NDArray[Any] | None) -> Bools:
    """(H W,) whether a port's pixel shows nothing: the background, and depth 1."""
    legal = np.ones(len(seen.empty), np.bool_)
    if color is not None:
        legal &= allows(background(scene, seen), color.reshape(-1, 3))
    if depth is not None:
        legal &= np.asarray(depth.reshape(-1) == 1.0)
    return legal
