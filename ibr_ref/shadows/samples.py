"""The light's samples (section 3.2.3): where each is, and where the object stands as it sees it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.scene import checks
from ibr_ref.shadows.containment import contains, solid, touched
from ibr_ref.shadows.inputs import Params, Scene
from ibr_ref.shadows.vertex import place

_STEP = 2.0 / 3.0
"""g: centres of cells three to an edge. Samples on the border would be 2 to 4 times farther from the area light."""

_NEAR = 1e-6
"""Room around the caster's box, as a share of its coordinates: more than what counts as touching it."""


class Sample(NamedTuple):
    """A sample of the light."""

    position: Floats
    """(3,) in world space."""
    displacement: Floats
    """(2,) position - centre, along the offset axes."""


def _positions(scene: Scene, params: Params) -> list[Floats]:
    if isinstance(params.light_samples, np.ndarray):
        return list(params.light_samples)
    centre, (a, b) = scene.light.arrays
    steps = {1: (), 5: (-_STEP, _STEP), 9: (-_STEP, 0.0, _STEP)}[int(params.light_samples)]  # type: ignore[arg-type]
    around = [(g_i, g_j) for g_j in steps for g_i in steps if (g_i, g_j) != (0.0, 0.0)]
    return [centre, *(centre + (g_i * a + g_j * b) for g_i, g_j in around)]


def samples_of(scene: Scene, params: Params) -> list[Sample]:
    """The samples in use, in order.

    Raises ValueError for a position outside the light's plane, inside the caster, or on a triangle.
    """
    centre = scene.light.arrays[0]
    receivers = [solid(np.asarray(mesh.vertices), np.asarray(mesh.triangles)) for mesh in scene.receivers]
    samples = []
    for i, position in enumerate(_positions(scene, params)):
        field = f"light_samples[{i}]" if isinstance(params.light_samples, np.ndarray) else "light.position"
        if not scene.in_plane(position - centre):
            raise checks.reject(
                field, position.tolist(), f"a point in the plane of offset_axes through {tuple(centre.tolist())}"
            )
        for k, receiver in enumerate(receivers):
            triangle = touched(receiver, position)
            if triangle is not None:
                where = f"a point off receivers[{k}] (it is on triangle {triangle})"
                raise checks.reject(field, position.tolist(), where)
        check_outside(field, scene, np.asarray(scene.offset), position)
        samples.append(Sample(position, np.array(scene.on_axes(position - centre))))
    return samples


def check_outside(field: str, scene: Scene, offset: Floats, position: Floats) -> None:
    """Raise ValueError for a light inside the caster at an offset, or on its surface.

    Its triangles are looked at only where the light is near its box: a warp must not cost more for a larger caster.
    """
    if not _is_near(scene, offset, position):
        return
    caster = solid(place(np.asarray(scene.caster.vertices), scene.axes, offset), np.asarray(scene.caster.triangles))
    if contains(caster, position) or touched(caster, position) is not None:
        raise checks.reject(
            field, position.tolist(), f"a point outside the caster (at offset {tuple(offset.tolist())})"
        )


def _is_near(scene: Scene, offset: Floats, position: Floats) -> bool:
    """Whether a position is in the caster's box at an offset, or beside it by no more than rounding."""
    low, high = place(scene.caster.bounds, scene.axes, offset)
    room = _NEAR * float(np.abs([low, high]).max())
    return bool(((low - room <= position) & (position <= high + room)).all())


def widened_range(scene: Scene, samples: list[Sample]) -> tuple[Floats, Floats]:
    """(2,) lowest and highest offsets, with room on either side for the object as any of the samples sees it."""
    ends = np.asarray(scene.offset_range)
    widening = np.max([np.abs(sample.displacement) for sample in samples], axis=0)
    return ends[:, 0] - widening, ends[:, 1] + widening


def seen_offset(scene: Scene, sample: Sample) -> Floats:
    """(2,) the object's offset as the sample sees it: moved the opposite way (section 2.3.1)."""
    return np.asarray(scene.offset) - sample.displacement
