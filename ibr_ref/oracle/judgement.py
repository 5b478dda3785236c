"""What a referee says of one stage of a port."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.findings import Cause, Nearest

Handed = Mapping[str, Any]
"""A port's arrays by their names in the contract, checked for shape and dtype: "color" (H, W, 3) uint8 or floats, "depth",
and any of the stages; an atlas as a tuple of pages."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Judgement:
    """One stage, element by element. Elements are pixels, (H, W), or vertices, texels, control points."""

    stage: str
    """As the method names it; "image" is the final picture and depth judged from the case alone."""
    element: str
    """What an element is: "pixel", "vertex", "texel", "control point"."""
    arrays: tuple[str, ...]
    """The port's arrays that were compared."""
    replayed: tuple[str, ...] = ()
    """The port's own arrays that the stage was fed with; what is missing came from the reference, with its bounds."""
    wrong: Bools
    """No legal outcome agrees with what the port has."""
    undecided: Bools
    """A legal alternative differs by more than one step of the search lattice, or shows in the final image."""
    width: NDArray[np.float64]
    """Width of the accepted set of continuous results (the widest of the element's numbers); NaN where there is none."""
    blame: NDArray[np.int8]
    """Index in `arrays`, which stand in order of computation, of the first one that disagrees; -1 where nothing does."""
    places: NDArray[np.int64] | None = None
    """(elements, k) where each of a row of elements stands in the arrays: page, row and column of an atlas. None: at its own
    index."""

    part: str = ""
    """What `Referee.trace` is asked for where a stage has several kinds of elements: an array of this kind."""

    def place(self, index: tuple[int, ...]) -> tuple[int, ...]:
        """An element's index in the port's arrays."""
        return index if self.places is None else tuple(self.places[index].tolist())

    def __post_init__(self) -> None:
        shapes = {a.shape for a in (self.wrong, self.undecided, self.width, self.blame)}
        if len(shapes) != 1:
            raise ValueError(f"judgement of {self.stage}: arrays of different shapes {sorted(shapes)}")


def spread_out(flags: Sequence[Bools], count: int) -> Bools:
    """(n,) of the elements of each of the flags (n,) some from everywhere: so many, fewer than twice as many, or all."""
    among = np.zeros_like(flags[0])
    for some in map(np.flatnonzero, flags):
        among[some[:: max(1, len(some) // count)]] = True
    return among


def up_to(judgements: Iterator[Judgement], *, first_wrong: bool) -> list[Judgement]:
    """All of them, or those up to the first that has a wrong element."""
    found = []
    for judgement in judgements:
        found.append(judgement)
        if first_wrong and judgement.wrong.any():
            break
    return found


@dataclass(frozen=True, kw_only=True)
class TraceRow:
    """One fetch, comparison or result in the computation of one element."""

    step: str
    """"linear search, sample 4: h < H"."""
    reference: str
    """What the reference has."""
    port: str
    """What the port has, or what it would have to have had; empty where it did not hand that in."""
    margin: float | None = None
    """How close a comparison came to the other outcome."""
    bound: float | None = None
    """The most that the device's freedom can move it; smaller than the margin: the decision is certain."""
    note: str = ""
    """"certain", "either way is legal", "differs"."""
    array: str = ""
    """The port's array whose numbers these are, where the row is that of one: it heads the witness."""
    index: tuple[int, ...] | None = None
    """Where they stand in that array, if not at the element's own index."""
    element: str = ""
    """What stands there, if not such an element."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A continuous parameter of a case, for the regression of small systematic errors."""

    name: str
    """As the case has it: "light.ambient"."""
    value: float
    step: float
    """Of the symmetric difference quotient."""
    moved: Callable[[float], Case]
    """The case with another value."""


class Referee(Protocol):
    """A method's judge."""

    @property
    def stages(self) -> Sequence[str]:
        """In the order of the pipeline, without "image"."""

    def judge_stages(
        self, case: Case, device: Device, handed: Handed, *, to_first_wrong: bool = False
    ) -> list[Judgement]:
        """Every stage of which an array is handed in, in order, each fed with the port's own arrays of the stages before.

        to_first_wrong: end with the first judgement that has a wrong element; those after it are not even computed.
        """

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        """The final colour, and depth where it is handed in, from the case alone."""

    def trace(self, case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
        """The computation of one element of a stage, reference and port side by side, replayed from the port's arrays.

        stage, index: of its judgement, or `Judgement.part`. The numbers of each array that was handed in have a row that
        says so (`TraceRow.array`).
        """

    def parameters(self, case: Case) -> list[Parameter]:
        """The continuous parameters that move the image."""


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """Which known bugs leave no element of a wrong stage unexplained."""

    causes: tuple[Cause, ...]
    given_up_after: int | None = None
    """After how many suspects the search was ended for what it costs; None: all were tried, each by itself."""
    nearest: Nearest | None = None
    """Where there are no causes, what leaves least."""


@runtime_checkable
class Glances(Protocol):
    """A referee that can look at a few elements of a stage, or of a picture, much sooner than at all."""

    def explains(self, case: Case, device: Device, handed: Handed, stage: str, among: NDArray[np.bool_]) -> bool:
        """Whether a device contradicts no element `among`, one after the other.

        stage: of its judgement, or `Judgement.part`. Of one whose elements hang together all are looked at.
        """


@runtime_checkable
class Explains(Protocol):
    """A judge that names bugs."""

    def causes(self, case: Case, device: Device, handed: Handed, wrong: Judgement) -> Explanation | None:
        """The known bugs that explain a wrong stage; None: not looked for."""


@runtime_checkable
class Recognizes(Protocol):
    """A judge that tells a bug that it has named before from others, much sooner than it names one."""

    def recognizes(self, case: Case, device: Device, handed: Handed, wrong: Judgement, cause: str) -> bool:
        """Whether the known bug of that name explains a wrong stage."""
