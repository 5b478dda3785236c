"""How the bugs are written down: a class in the place of one stage, its fault in its docstring."""

from __future__ import annotations

import re

from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.ports.splatting.port import replaced_stage, with_stage
from ibr_ref.oracle.ports.splatting.stage import Stage


def mutant(stage: type[Stage], *, small: bool = False, hidden: str = "") -> Mutant:
    """The port with one broken stage, named in words like the class and wrong where the class says."""
    return Mutant(
        name=re.sub(r"(?<!^)(?=[A-Z])|(?<=[a-z])(?=\d)", "-", stage.__name__).lower(),
        fault=" ".join((stage.__doc__ or "").split()),
        stage=replaced_stage(stage),
        port=with_stage(stage),
        small=small,
        hidden=hidden,
    )
