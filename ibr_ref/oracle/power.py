"""How much a case can judge: the share of its pixels that a device's freedom leaves open."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import PROFILES, profile_of
from ibr_ref.oracle.referees import referee

LITTLE = 0.9
"""A case that judges less of its pixels under the profile that it is meant for should be another one."""


@np.errstate(all="ignore")
def undecided(case: Case) -> dict[str, float]:
    """Share of the pixels at which a right port may show something else, by device profile.

    The reference's own picture is judged, in 8 bits; renders the case. Takes as long as a verdict for each profile.
    """
    picture = {"color": color_bytes(case.frame.color)}
    shares = {}
    for name, device in PROFILES.items():
        shares[name] = float(referee(case.method).judge_image(case, device, picture).undecided.mean())
    return shares


def said(shares: Mapping[str, float]) -> str:
    """A line: "judges 99.7 % of the pixels under d3d11, ...", and that it is little where it is."""
    judged = ", ".join(f"{100 * (1 - share):.1f} % under {name}" for name, share in shares.items())
    profile = profile_of(shares)
    line = f"judges {judged} (of the pixels); meant for {profile}"
    if 1 - shares[profile] < LITTLE:
        line += (
            ", which is little: rounding may turn the rest. Smoother maps, fewer steps, a threshold off the lattice of "
            "heights or a larger view leave less open"
        )
    return line
