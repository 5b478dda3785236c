"""How control points were chosen, and what they are expected to reach: kept with the maps that they belong to."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

from ibr_ref.scene import checks
from ibr_ref.shadows.selection import Reach

GOOD = 0.8
"""Mean IoU: what is expected to reach less is said to be poor."""

_ALLOWED = "what `Maps.save` wrote there"


@dataclass(frozen=True, kw_only=True)
class Placement:
    """Of automatic control points ("fast" or "best")."""

    asked: str
    """The name that was asked for."""
    interpolation: str
    """The pace that they were registered and compared for."""
    places: int
    """How many places they were compared at; none of them is one that was registered at."""
    chosen: Reach
    """What was taken, and what it reached there."""
    others: tuple[Reach, ...]
    """What else was tried, simpler ways among it."""

    @property
    def good(self) -> bool:
        """Whether the shadow is expected to be much like the rendered one."""
        return self.chosen.mean >= GOOD

    @property
    def text(self) -> str:
        """As `Maps.save` writes it."""
        return json.dumps(asdict(self))

    @classmethod
    def read(cls, text: str) -> Placement:
        """From `text`. Raises ValueError for anything else."""
        try:
            found = json.loads(text)
            placement = cls(
                asked=_word(found.pop("asked")),
                interpolation=_word(found.pop("interpolation")),
                places=checks.whole("choice.places", found.pop("places"), low=1, high=2**31),
                chosen=_reach(found.pop("chosen")),
                others=tuple(_reach(other) for other in found.pop("others")),
            )
        except (AttributeError, KeyError, TypeError, ValueError):
            raise checks.reject("choice", text[:80], _ALLOWED) from None
        if found:
            raise checks.reject("choice", next(iter(found)), _ALLOWED)
        return placement


def _word(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError
    return value


def _reach(value: object) -> Reach:
    if not isinstance(value, list) or len(value) != 3:
        raise TypeError
    mean, worst = (checks.number("choice", number, low=0.0, high=1.0) for number in value[1:])
    return Reach(_word(value[0]), mean, worst)
