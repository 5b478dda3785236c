"""What a verdict is made of, and all that it says: models, which the JSON follows."""

from __future__ import annotations

from enum import StrEnum

from pydantic import BaseModel, ConfigDict

from ibr_ref.oracle.device import spelled


class Outcome(StrEnum):
    """What a verdict can be, and the exit code of `ibr-ref check`."""

    PASS = "PASS"
    FAIL = "FAIL"
    INCONCLUSIVE = "INCONCLUSIVE"

    @property
    def exit_code(self) -> int:
        """0 PASS, 1 FAIL, 2 INCONCLUSIVE."""
        return [*Outcome].index(self)


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Box(_Record):
    """Where wrong elements lie: the first and last index along each axis, both inclusive."""

    first: tuple[int, ...]
    last: tuple[int, ...]


class TraceStep(_Record):
    """One fetch, comparison or result on the way to an element (`judgement.TraceRow`)."""

    step: str
    reference: str
    port: str
    margin: float | None = None
    bound: float | None = None
    note: str = ""


class Witness(_Record):
    """One wrong element, the smallest: the first in reading order among those that no undecided one touches.

    Its numbers are a row of its trace: the reference's are replayed from the port's arrays of the stages before.
    """

    stage: str
    element: str
    index: tuple[int, ...]
    """In the array; of an atlas the page comes first, of several light samples the sample."""
    array: str
    reference: str
    port: str
    trace: tuple[TraceStep, ...]


class Cause(_Record):
    """A known bug, or another number than the case has, whose program leaves nothing of what was handed in unexplained."""

    name: str
    says: str
    """What such a port does, in a sentence; of two bugs in two."""
    together: tuple[str, ...] = ()
    """The names of two of them of which neither explains it alone; empty: it is one."""


class Nearest(_Record):
    """Where nothing known explains a stage: the bug, or the number, whose program leaves the fewest elements unexplained."""

    name: str
    says: str
    left: int
    """Elements that it leaves, of all that are judged."""
    element: str
    index: tuple[int, ...]
    """Of the first that it leaves."""


class StageVerdict(_Record):
    """One stage, judged on the port's own inputs where it handed them in; "image" is the picture, judged from the case."""

    stage: str
    element: str
    arrays: tuple[str, ...]
    """The port's arrays that were compared."""
    replayed: tuple[str, ...]
    """The port's own arrays that the stage was fed with."""
    elements: int
    wrong: int
    undecided: int
    box: Box | None
    """Around the wrong elements."""
    blamed: dict[str, int]
    """For each array in how many elements it is the first that disagrees."""
    median_width: float | None
    """Of the accepted sets of continuous results."""
    witness: Witness | None = None
    """Of a wrong stage."""
    causes: tuple[Cause, ...] | None = None
    """Known bugs that explain a wrong stage; None where none was looked for."""
    nearest: Nearest | None = None
    """Where none does."""

    @property
    def right(self) -> bool:
        """Whether every element is legal."""
        return self.wrong == 0


class Convention(_Record):
    """A common mistake of conventions, undone on the port's image: how many pixels are wrong then."""

    name: str
    wrong: int
    explains: bool
    """No pixel is left, or fewer than a tenth."""


class Bias(_Record):
    """A parameter whose change would explain the difference."""

    parameter: str
    value: float
    """What the case has."""
    looks_like: float
    """What the port seems to have."""
    explained: float
    """Share of the squared difference that the change explains, in [0, 1]."""
    legal: float
    """The largest change that a legal device could seem to have."""


class Findings(_Record):
    """What the oracle says of one submission."""

    outcome: Outcome
    case: str
    method: str
    reasons: tuple[str, ...] = ()
    """Of an INCONCLUSIVE: what is missing or unusable."""
    profile: str | None = None
    """PASS: the tightest profile tried that explains every element. FAIL: the one that the counts are by."""
    numbers: dict[str, int | float | str] = {}
    """What the device has beside the profile: declared, or found to be needed (`declaration.NUMBERS`)."""
    declared: bool = False
    """Whether the port, or the caller, named the profile."""
    tried: dict[str, int] = {}
    """Devices in the order in which they were tried, and how many elements each leaves unexplained: all of them where the
    verdict is by that device, else those of the first entry of `stages` that it calls wrong."""
    stages: tuple[StageVerdict, ...] = ()
    not_judged: tuple[str, ...] = ()
    """Arrays that were handed in, and of which no port's are right or wrong: margins, and what a search costs."""
    first_wrong_stage: str | None = None
    needs: dict[str, int | float | str] = {}
    """What the device would have to have for that stage to be right."""
    causes: tuple[Cause, ...] | None = None
    """Known bugs that explain the stage; several: this case does not tell them apart; none: no known one does. None where
    none was looked for."""
    nearest: Nearest | None = None
    """Where none does, and one explains a part of it."""
    suspects: int | None = None
    """How many known bugs were tried before the search was ended for what it costs, so that others may explain the stage
    too; None where all were."""
    conventions: tuple[Convention, ...] = ()
    """Those that were worth a judgement."""
    biases: tuple[Bias, ...] = ()
    undecided_share: float | None = None
    """Of the picture's pixels that something is drawn at, or may be."""
    median_width: float | None = None
    """Of the picture's accepted colours."""

    @property
    def device(self) -> str | None:
        """The profile, with the numbers that it has beside it."""
        return self.profile and spelled(self.profile, self.numbers)

    @property
    def witness(self) -> Witness | None:
        """The first wrong stage's; each other wrong one has its own."""
        return next(iter(self.witnesses), None)

    @property
    def witnesses(self) -> tuple[Witness, ...]:
        """Of all wrong stages, in order."""
        return tuple(stage.witness for stage in self.stages if stage.witness is not None)
