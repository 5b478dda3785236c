"""A judge for each method: which results of each stage a correct port may have."""

from __future__ import annotations

from functools import cache

from ibr_ref.methods import Method, named
from ibr_ref.oracle.judgement import Referee


def referee(method: str) -> Referee:
    """The judge of a method: one, because it keeps what follows from the last case and device."""
    return _judge(named(method))


@cache
def _judge(method: Method) -> Referee:
    made: Referee = method.referee.open()()
    return made
