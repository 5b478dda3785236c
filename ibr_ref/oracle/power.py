"""How much a case can judge: the share of its drawn pixels that a device's freedom leaves open."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import PROFILES, profile_of
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees import referee

LITTLE = 0.9
"""A case that judges less of its pixels under the profile that it is meant for should be another one."""


@np.errstate(all="ignore")
def undecided(case: Case) -> dict[str, float]:
    """Share of the drawn pixels at which a right port may show something else, by device profile.

    The reference's own picture is judged, in 8 bits; renders the case. Takes as long as a verdict for each profile.
    """
    picture = {"color": color_bytes(case.frame.color)}
    shares = {}
    for name, device in PROFILES.items():
        shares[name] = share_of_drawn(case, referee(case.method).judge_image(case, device, picture))
    return shares


def share_of_drawn(case: Case, image: Judgement) -> float:
    """How much of the pixels that show something, or may, is undecided: a background would make every share small."""
    shown = drawn(case, image)
    return float(image.undecided[shown].mean()) if shown.any() else 0.0


def drawn(case: Case, image: Judgement) -> NDArray[np.bool_]:
    """(H, W) the pixels that show something, or may."""
    return np.asarray(image.undecided | (case.frame.depth < 1.0), np.bool_)


def said(shares: Mapping[str, float]) -> str:
    """A line: "judges 99.7 % of the pixels under d3d11, ...", and that it is little where it is."""
    judged = ", ".join(f"{100 * (1 - share):.1f} % under {name}" for name, share in shares.items())
    profile = profile_of(shares)
    line = f"judges {judged} (of the drawn pixels); meant for {profile}"
    if 1 - shares[profile] < LITTLE:
        line += (
            ", which is little: rounding may turn the rest. Smoother maps, fewer steps, a threshold off the lattice of "
            "heights or a larger view leave less open"
        )
    return line
