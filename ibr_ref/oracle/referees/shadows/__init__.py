"""The judge of shadows by image warping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ibr_ref.array_types import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement, Parameter, TraceRow, up_to
from ibr_ref.oracle.referees.shadows.image import Accepted
from ibr_ref.oracle.referees.shadows.inputs import HANDED_OVER, Inputs
from ibr_ref.oracle.referees.shadows.parameters import parameters
from ibr_ref.oracle.referees.shadows.stages import PIXELS, Replay, judged, judgements, part_of
from ibr_ref.oracle.referees.shadows.trace import trace

_MADE = ("maps.positions", "maps.image", "controls")
"""Of what the case hands over."""


class ShadowsReferee:
    """Methods "warp", "direct" and "grid"."""

    stages: Sequence[str] = ("maps", "controls", "warp", "depth", "project", "accumulate", "resolve")
    """"depth" is which surface the camera sees: what is projected onto it comes after."""

    def __init__(self) -> None:
        self._alone: Inputs | None = None
        self._accepted: Accepted | None = None

    def judge_stages(
        self, case: Case, device: Device, handed: Handed, *, to_first_wrong: bool = False
    ) -> list[Judgement]:
        """In order; a stage of several kinds of elements (cells, grids, texels) has a judgement for each."""
        return up_to(judgements(self._given(case, device, handed)), first_wrong=to_first_wrong)

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        """The picture from the case alone, with the maps that it hands over, or with the port's own if these are legal."""
        alone = self._of(case, device)
        if self._accepted is None:
            self._accepted = Accepted.of(alone)
        judgement = self._accepted.judge(handed)
        own = {name: handed[name] for name in HANDED_OVER if name in handed}
        if not own or not judgement.wrong.any() or case.params.method != "warp":
            return judgement
        given = Inputs(case, device, own, alone)
        if any(made is not None and made.wrong.any() for made in (judged(given, part) for part in _MADE)):
            return judgement
        other = Accepted.of(given).judge(handed)
        return judgement if judgement.wrong.sum() <= other.wrong.sum() else other

    def explains(self, case: Case, device: Device, handed: Handed, stage: str, among: Bools) -> bool:
        """Whether no element `among` is wrong in a part of a stage, or in the picture.

        A picture beside own maps may be made with them: it is not contradicted so soon.
        """
        part = part_of(stage)
        if part == "image" and {*HANDED_OVER} & {*handed}:
            return True
        given = self._given(case, device, handed, stage)
        return not Replay(replace(given, among=among) if part in PIXELS else given).judge(part).wrong.any()

    def _of(self, case: Case, device: Device) -> Inputs:
        """What follows from the last case and device is kept for further submissions."""
        if self._alone is None or self._alone.case is not case or self._alone.device is not device:
            self._alone, self._accepted = Inputs(case, device), None
        return self._alone

    def trace(self, case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
        """The computation of one element; stage: a stage or an array, index: that in its judgement."""
        return trace(self._given(case, device, handed), stage, index)

    def causes(self, case: Case, device: Device, handed: Handed, wrong: Judgement) -> Explanation | None:
        """The known bugs that explain a wrong stage."""
        from ibr_ref.oracle.referees.shadows.cause import causes  # with all known bugs: what passes needs none

        return causes(self._given(case, device, handed, wrong.stage), handed, wrong)

    def recognizes(self, case: Case, device: Device, handed: Handed, wrong: Judgement, cause: str) -> bool:
        """Whether the known bug of a name explains a wrong stage."""
        from ibr_ref.oracle.referees.shadows.cause import recognizes

        return recognizes(self._given(case, device, handed, wrong.stage), wrong, cause)

    def _given(self, case: Case, device: Device, handed: Handed, stage: str = "") -> Inputs:
        """stage: of a picture by itself nothing of the port is fed to anything."""
        if stage == "image":
            return Inputs(case, device, {}, self._of(case, device), picture=handed)
        return Inputs(case, device, handed, self._of(case, device))

    def parameters(self, case: Case) -> list[Parameter]:
        """What moves the image."""
        return parameters(case)
