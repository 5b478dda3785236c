"""Comparison of the package with its naive twin: every array, by name, shape, type and value."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref import displacement
from ibr_ref.displacement import Params, Scene
from ibr_ref.io import Frame
from tests.naive import displacement as twin

Arrays = dict[str, NDArray[np.generic]]


def arrays_of(frame: Frame) -> Arrays:
    """The stages of a frame, and its picture and depth with them."""
    return {**frame.stages, "color": frame.color, "depth": frame.depth}


def twin_arrays(scene: Scene, params: Params) -> Arrays:
    """The same by the naive twin."""
    stages, color, depth = twin.render(scene, params)
    return {**stages, "color": color, "depth": depth}


def difference(name: str, ours: NDArray[np.generic], theirs: NDArray[np.generic]) -> str:
    """Where two arrays differ in a bit (NaN equals NaN, -0.0 equals 0.0), in words; empty where they do not."""
    if (ours.shape, ours.dtype) != (theirs.shape, theirs.dtype):
        return f"{name}: package {ours.shape} {ours.dtype}, twin {theirs.shape} {theirs.dtype}"
    differ = (ours != theirs) & ~((ours != ours) & (theirs != theirs))
    if not differ.any():
        return ""
    where = tuple(int(i) for i in np.argwhere(differ)[0])
    place = f"vertex {where[0]}" if name.startswith("vertex.") else f"pixel (x={where[1]}, y={where[0]})"
    channel = f" channel {where[-1]}" if len(where) > (1 if name.startswith("vertex.") else 2) else ""
    count = np.count_nonzero(differ)
    return (
        f"{name}: {place}{channel}: package {ours[where]!r}, twin {theirs[where]!r} ({count} of {differ.size} differ)"
    )


def differences(ours: Arrays, theirs: Arrays) -> str:
    """All differences between two frames, in the order of the stages; empty where there are none."""
    lines = [f"{name}: only in one of both" for name in sorted(set(ours) ^ set(theirs))]
    lines += [difference(name, ours[name], theirs[name]) for name in ours if name in theirs]
    return "\n".join(line for line in lines if line)


def check_agreement(scene: Scene, params: Params) -> Frame:
    """Render with both and compare everything; gives the package's frame."""
    frame = displacement.render(scene, params)
    assert not (report := differences(arrays_of(frame), twin_arrays(scene, params))), report
    return frame


def check_without_stages(scene: Scene, params: Params, frame: Frame) -> None:
    """The same picture and depth come out where no stages are kept."""
    bare = displacement.render(scene, params, stages=False)
    assert bare.stages == {}
    ours = {"color": bare.color, "depth": bare.depth}
    assert not (report := differences(ours, {"color": frame.color, "depth": frame.depth})), f"stages=False: {report}"
