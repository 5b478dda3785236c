"""Comparison of the package with its naive twins: every array, by name, shape, type and value."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import Frame

Arrays = dict[str, NDArray[np.generic]]


def flat(stages: dict[str, Any]) -> Arrays:
    """Stages of several arrays as several arrays."""
    arrays: Arrays = {}
    for name, stage in stages.items():
        arrays.update({f"{name}.{i}": a for i, a in enumerate(stage)} if isinstance(stage, tuple) else {name: stage})
    return arrays


def arrays_of(frame: Frame) -> Arrays:
    """The stages of a frame, and its picture and depth with them."""
    return {**flat(frame.stages), "color": frame.color, "depth": frame.depth}


def difference(name: str, ours: NDArray[np.generic], theirs: NDArray[np.generic]) -> str:
    """Where two arrays differ in a bit (NaN equals NaN, -0.0 equals 0.0), in words; empty where they do not."""
    if (ours.shape, ours.dtype) != (theirs.shape, theirs.dtype):
        return f"{name}: package {ours.shape} {ours.dtype}, twin {theirs.shape} {theirs.dtype}"
    differ = (ours != theirs) & ~((ours != ours) & (theirs != theirs))
    if not differ.any():
        return ""
    where = tuple(int(i) for i in np.argwhere(differ)[0])
    count = np.count_nonzero(differ)
    return f"{name}{list(where)}: package {ours[where]!r}, twin {theirs[where]!r} ({count} of {differ.size} differ)"


def differences(ours: Arrays, theirs: Arrays) -> str:
    """All differences between two frames, in the order of the stages; empty where there are none."""
    lines = [f"{name}: only in one of both" for name in sorted(set(ours) ^ set(theirs))]
    lines += [difference(name, ours[name], theirs[name]) for name in ours if name in theirs]
    return "\n".join(line for line in lines if line)


def check_agreement(method: ModuleType, twin: ModuleType, scene: Any, params: Any) -> Frame:
    """Render with a method of the package and with its twin, and compare everything; gives the package's frame."""
    frame = method.render(scene, params)
    stages, color, depth = twin.render(scene, params)
    theirs = {**flat(stages), "color": color, "depth": depth}
    assert not (report := differences(arrays_of(frame), theirs)), report
    return frame


def check_without_stages(method: ModuleType, scene: Any, params: Any, frame: Frame, **options: Any) -> None:
    """The same picture and depth come out where no stages are kept."""
    bare = method.render(scene, params, stages=False, **options)
    assert bare.stages == {}
    ours = {"color": bare.color, "depth": bare.depth}
    assert not (report := differences(ours, {"color": frame.color, "depth": frame.depth})), f"stages=False: {report}"
