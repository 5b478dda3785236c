"""What the oracle does not see: at what share of hit pixels something that no device draws would be called right."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.cases import Case, build, names
from ibr_ref.oracle.device import PROFILES, Device
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.referees import referee

MOVED = 1e-3
"""Of the range of window depths."""
SEED = 1


@dataclass(frozen=True, kw_only=True)
class Sight:
    """Of a case by a profile: shares in [0, 1] of the hit pixels that are called right. Hit: nearer than the background."""

    method: str
    case: str
    profile: str
    hits: int
    color_of_picture: float
    """With a uniformly random colour, in a picture without depth."""
    color_beside_depth: float
    """The same with the right depth."""
    color_beside_stages: float
    """And with all stages."""
    depth_beside_color: float
    """With the right colour, and a depth that is off by 1e-3."""
    depth_beside_stages: float


def sights(method: str, *, kinds: Sequence[str]) -> Iterator[Sight]:
    """Of all cases of some kinds, by every profile."""
    for case in map(build, names(method)):
        if case.kind in kinds:
            for device in PROFILES.values():
                yield sight(case, device)


def sight(case: Case, device: Device) -> Sight:
    """Of one case by one device; 0 where nothing is hit."""
    frame = case.frame
    hit: NDArray[np.bool_] = frame.depth < 1.0
    color, depth = frame.color.copy(), frame.depth.copy()
    color[hit] = np.random.default_rng(SEED).random((int(hit.sum()), 3))
    depth[hit] += np.where(depth[hit] < 1.0 - 2.0 * MOVED, MOVED, -MOVED)

    def share(handed: Handed) -> float:
        return float((_accepted(case, device, handed) & hit).sum() / max(int(hit.sum()), 1))

    return Sight(
        method=case.method,
        case=case.name,
        profile=device.name,
        hits=int(hit.sum()),
        color_of_picture=share({"color": color}),
        color_beside_depth=share({"color": color, "depth": frame.depth}),
        color_beside_stages=share({**frame.stages, "color": color, "depth": frame.depth}),
        depth_beside_color=share({"color": frame.color, "depth": depth}),
        depth_beside_stages=share({**frame.stages, "color": frame.color, "depth": depth}),
    )


def _accepted(case: Case, device: Device, handed: Handed) -> NDArray[np.bool_]:
    """(H, W) pixels that no judgement calls wrong."""
    judge_of, picture = referee(case.method), {"color", "depth"}
    judgements = [] if {*handed} <= picture else judge_of.judge_stages(case, device, handed)
    image = judge_of.judge_image(case, device, {name: handed[name] for name in picture & {*handed}})
    accepted: NDArray[np.bool_] = ~image.wrong
    for judgement in judgements:
        if judgement.wrong.shape == accepted.shape:
            accepted &= ~judgement.wrong
    return accepted
