"""A judge for each method: which results of each stage a correct port may have."""

from __future__ import annotations

from functools import cache

from ibr_ref.oracle.judgement import Referee


@cache
def referee(method: str) -> Referee:
    """The judge of a method: one, because it keeps what follows from the last case and device."""
    if method == "displacement":
        from ibr_ref.oracle.referees.displacement import DisplacementReferee

        return DisplacementReferee()
    if method == "splatting":
        from ibr_ref.oracle.referees.splatting import SplattingReferee

        return SplattingReferee()
    from ibr_ref.oracle.referees.shadows import ShadowsReferee

    return ShadowsReferee()
