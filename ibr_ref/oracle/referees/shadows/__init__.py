"""The judge of shadows by image warping."""

from __future__ import annotations

from collections.abc import Sequence

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement, Parameter, TraceRow, up_to
from ibr_ref.oracle.referees.shadows import replay_maps, replay_picture
from ibr_ref.oracle.referees.shadows.image import Accepted
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.parameters import parameters
from ibr_ref.oracle.referees.shadows.trace import trace

_JUDGES = (
    replay_maps.positions,
    replay_maps.depths,
    replay_maps.images,
    replay_maps.controls,
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
        found = (judge(given) for judge in _JUDGES)
        return up_to((judgement for judgement in found if judgement is not None), first_wrong=to_first_wrong)

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        """The picture from the case alone."""
        alone = self._of(case, device)
        if self._accepted is None:
            self._accepted = Accepted.of(alone)
        return self._accepted.judge(handed)

    def _of(self, case: Case, device: Device) -> Inputs:
        """What follows from the last case and device is kept for further submissions."""
        if self._alone is None or self._alone.case is not case or self._alone.device is not device:
            self._alone, self._accepted = Inputs(case, device), None
        return self._alone

    def trace(self, case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
        """The computation of one element; index: that in its stage's judgement."""
        return trace(case, device, handed, stage, index)

    def parameters(self, case: Case) -> list[Parameter]:
        """What moves the image."""
        return parameters(case)
