"""The judge of shadows by image warping."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import chain

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement, Parameter, TraceRow, up_to
from ibr_ref.oracle.referees.shadows import replay_maps, replay_picture
from ibr_ref.oracle.referees.shadows.image import Accepted
from ibr_ref.oracle.referees.shadows.inputs import HANDED_OVER, Inputs
from ibr_ref.oracle.referees.shadows.parameters import parameters
from ibr_ref.oracle.referees.shadows.trace import trace

_MADE = (replay_maps.positions, replay_maps.depths, replay_maps.images, replay_maps.controls)
_JUDGES = (
    replay_maps.spots,
    replay_maps.shares,
    replay_maps.row_grids,
    replay_maps.rows,
    replay_maps.grids,
    replay_maps.warped,
    replay_picture.depth,
    replay_picture.projected,
    replay_picture.sums,
    replay_picture.colors,
)


def _with_either_maps(judge: Callable[[Inputs], Judgement | None], given: Inputs) -> Judgement | None:
    """Fed with the port's own nine maps, or else with those that the case hands over."""
    judgement = judge(given)
    if judgement is None or not judgement.wrong.any() or not {*HANDED_OVER} & {*judgement.replayed}:
        return judgement
    assert given.as_the_case is not None
    other = judge(given.as_the_case)
    return judgement if other is None or judgement.wrong.sum() <= other.wrong.sum() else other


class ShadowsReferee:
    """Methods "warp" and "direct"."""

    stages: Sequence[str] = ("maps", "controls", "warp", "depth", "project", "accumulate", "resolve")
    """"depth" is which surface the camera sees: what is projected onto it comes after."""

    def __init__(self) -> None:
        self._alone: Inputs | None = None
        self._accepted: Accepted | None = None

    def judge_stages(
        self, case: Case, device: Device, handed: Handed, *, to_first_wrong: bool = False
    ) -> list[Judgement]:
        """In order; a stage of several kinds of elements (cells, grids, texels) has a judgement for each."""
        given = Inputs(case, device, handed, self._of(case, device))
        found = chain((judge(given) for judge in _MADE), (_with_either_maps(judge, given) for judge in _JUDGES))
        return up_to((judgement for judgement in found if judgement is not None), first_wrong=to_first_wrong)

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        """The picture from the case alone, with the maps that it hands over, or with the port's own if these are legal."""
        alone = self._of(case, device)
        if self._accepted is None:
            self._accepted = Accepted.of(alone)
        judgement = self._accepted.judge(handed)
        own = {name: handed[name] for name in HANDED_OVER if name in handed}
        if not own or not judgement.wrong.any() or case.params.method == "direct":
            return judgement
        given = Inputs(case, device, own, alone)
        if any(made is not None and made.wrong.any() for made in (judge(given) for judge in _MADE)):
            return judgement
        other = Accepted.of(given).judge(handed)
        return judgement if judgement.wrong.sum() <= other.wrong.sum() else other

    def _of(self, case: Case, device: Device) -> Inputs:
        """What follows from the last case and device is kept for further submissions."""
        if self._alone is None or self._alone.case is not case or self._alone.device is not device:
            self._alone, self._accepted = Inputs(case, device), None
        return self._alone

    def trace(self, case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
        """The computation of one element; stage: a stage or an array, index: that in its judgement."""
        return trace(Inputs(case, device, handed, self._of(case, device)), stage, index)

    def parameters(self, case: Case) -> list[Parameter]:
        """What moves the image."""
        return parameters(case)
