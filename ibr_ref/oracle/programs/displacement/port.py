"""Protruded displacement mapping as someone ports it: NumPy, one array operation for all fragments of a volume.

Written from the pages of the contract, without a look at the method's kernels (those of the shared rasterizer were known).
Three rules that the pages leave open were settled by trial against the reference: a hit at k = K is none on the volume's
sides too; a fragment on a side's lower edge, h = 0, lies over the polygon; a mapped normal that vanishes gives n.

Each operation in which a bug can hide is a method of its own, so that a broken port is a subclass that overrides one.

It has no guard band: no corner may come nearer to the eye than that its window coordinates stay below 2^22 pixels.
"""

from __future__ import annotations

from functools import cache
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.programs.displacement.case import Bools
from ibr_ref.oracle.programs.displacement.raster import Raster
from ibr_ref.oracle.programs.displacement.resolve import Drawn, Resolve
from ibr_ref.oracle.programs.displacement.shade import Shade
from ibr_ref.scene.checks import choice


class Port(Shade, Resolve, Raster):
    """The stages in order: vertex, raster, march, shade, resolve. A `PlainPort`.

    Of another search than the protruded one it is that search's program: `Port(scene, params, ...)`, and any class with
    something else overridden, is made one with what that search overrides.
    """

    def __init_subclass__(cls, search: str | None = None) -> None:
        """search: `Params.method`, of a class that is that search's program."""
        super().__init_subclass__()
        if search is not None:
            PROGRAMS[search] = cls

    def __new__(cls, scene: Any, params: Any, *_: Any) -> Self:
        """Raises ValueError for a search that has no program."""
        kind: Any = searching(cls, params.method)  # type: ignore[arg-type]  # a class, which can be hashed
        found: Self = super().__new__(kind)
        return found

    def render(self, among: Bools | None = None) -> dict[str, NDArray[np.generic]]:
        """All stage arrays of the contract but the margins, "color" (H, W, 3) and "depth" (H, W).

        among: (H, W) pixels that are drawn; the others stay bare. None: all.
        """
        clip, corners, drawn, triangles = [np.zeros((0, 4))], [np.zeros((0, 3))], [], 0
        for patch in self.patches():
            quads = self.quads(patch)
            clip += [quad.clip for quad in quads]
            corners += [self.written_corners(patch, quad) for quad in quads]
            fragments = self.fragments(quads, triangles)
            triangles = int(fragments.triangle.max(initial=triangles)) + 1
            if among is not None:
                fragments = fragments.at(among)
            hits = self.march(patch, fragments)
            drawn.append(Drawn(patch, fragments, hits, self.shade(patch, hits)))
        return {
            "vertex.clip": np.concatenate(clip),
            "vertex.patch": np.concatenate(corners),
            **self.resolve(drawn),
        }


PROGRAMS: dict[str, type[Port]] = {"protruded": Port}
"""By `Params.method`; those below the polygon enter themselves."""


@cache
def searching(kind: type[Any], method: str) -> type[Any]:
    """A kind of port with a search: what the kind overrides comes first, then the search's own.

    Raises ValueError for a search that has no program, and TypeError for a kind that is another search's alone.
    """
    choice("method", method, tuple(PROGRAMS))
    search = PROGRAMS[method]
    if issubclass(kind, search):
        return kind
    if issubclass(search, kind):
        return search
    others = [name for name, other in PROGRAMS.items() if issubclass(kind, other) and not issubclass(search, other)]
    if others:
        raise TypeError(f"{kind.__name__}: found method = {method!r}, allowed: {' | '.join(others)}")
    return type(kind.__name__, (kind, search), {"__doc__": kind.__doc__, "__module__": kind.__module__})
