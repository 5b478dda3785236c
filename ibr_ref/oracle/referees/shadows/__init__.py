"""The judge of shadows by image warping."""

from __future__ import annotations

from collections.abc import Sequence

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.shadows import image, replay_maps, replay_picture
from ibr_ref.oracle.referees.shadows.inputs import Inputs

_JUDGES = (
    replay_maps.positions,
    replay_maps.images,
    replay_maps.controls,
    replay_maps.spots,
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

    def judge_stages(self, case: Case, device: Device, handed: Handed) -> list[Judgement]:
        """In order; a stage of several kinds of elements (cells, grids, texels) has a judgement for each."""
        given = Inputs(case, device, handed)
        return [found for found in (judge(given) for judge in _JUDGES) if found is not None]

    def judge_image(self, case: Case, device: Device, handed: Handed) -> Judgement:
        """The picture from the case alone."""
        return image.judge(case, device, handed)
