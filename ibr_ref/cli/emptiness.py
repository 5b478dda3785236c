"""What is said of a picture that shows less than was asked for: one line on standard error, exit code 0."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ibr_ref.pipeline.culling import Culled
    from ibr_ref.shadows.culling import Cut


def say(shown: bool, culled: Callable[[], Culled]) -> None:
    """Why a picture is empty, if nothing is shown."""
    if shown:
        return
    found = culled()
    why = ", through which no line of sight meets the shape" if found.drawn else ""
    print(f"ibr-ref: nothing is drawn: {found.words()}{why}", file=sys.stderr)


def say_cut(cut: Cut, name: str = "") -> None:
    """What the light's frustum does not hold, if anything; name: of the caster and the light, where there are several."""
    if cut.cut:
        print(
            f"ibr-ref: {name}the light's frustum does not hold the caster, whose shadow is cut: {cut.words()}",
            file=sys.stderr,
        )
