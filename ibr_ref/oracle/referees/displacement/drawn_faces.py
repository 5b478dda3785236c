"""Stage vertex of a port that draws more or fewer faces than there are: which ones are missing, and which should not be."""

from __future__ import annotations

from difflib import SequenceMatcher

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.judgement import Judgement, TraceRow
from ibr_ref.oracle.programs.displacement.vertex import QUADS
from ibr_ref.oracle.referees.displacement.replay import Port
from ibr_ref.oracle.referees.rows import told

FACES = ("base", "u=0", "u=1", "v=0", "v=1", "top")
NEAR = 1e-3
"""Of corners: a face is recognized by them, whether they are right or not."""

Face = tuple[int, int]
"""Polygon and number; -1 of what is not known."""


def other_faces(port: Port) -> str | None:
    """The first of the vertex stage's arrays that has another number of rows than the reference's."""
    count = 4 * len(_drawn(port))
    return next((name for name in port.names("vertex") if len(port.handed[name]) != count), None)


def judge_faces(port: Port) -> Judgement:
    """The faces that are missing, and those that should not be; their places are those in `faces_rows`."""
    places = np.flatnonzero([mine != theirs for mine, theirs in _compared(port)])
    wrong = np.ones(len(places), np.bool_)
    name = other_faces(port)
    assert name is not None
    return Judgement(
        stage="vertex",
        element="face",
        arrays=port.names("vertex"),
        wrong=wrong,
        undecided=np.zeros_like(wrong),
        width=np.full(wrong.shape, np.nan),
        blame=np.full(wrong.shape, port.names("vertex").index(name), np.int8),
        places=places[:, np.newaxis],
    )


def faces_rows(port: Port) -> list[TraceRow]:
    """The reference's faces, then those that the port has besides."""
    name = other_faces(port) or ""
    return [
        told(f"face {i}", _named(mine), _named(theirs), array=name, index=(i,))
        for i, (mine, theirs) in enumerate(_compared(port))
    ]


def _named(face: Face | None) -> str:
    if face is None:
        return "nothing"
    polygon, number = face
    known = FACES[number] if number >= 0 else "no face of a polygon"
    return f"polygon {polygon}, {known}" if polygon >= 0 else known


def _drawn(port: Port) -> list[Face]:
    return [(p, quad.face) for p, quads in enumerate(port.model.quads) for quad in quads]


def _compared(port: Port) -> list[tuple[Face | None, Face | None]]:
    """Pairs of the reference's face and the port's; those that it has besides at the end."""
    drawn = _drawn(port)
    found = _recognized(port)
    ours = drawn if any(p >= 0 for p, _ in found) else [(-1, number) for _, number in drawn]
    theirs: list[Face | None] = [None] * len(drawn)
    besides: list[tuple[Face | None, Face | None]] = []
    for kind, a, b, c, d in SequenceMatcher(None, ours, found, autojunk=False).get_opcodes():
        if kind == "equal":
            theirs[a:b] = drawn[a:b]
        else:
            besides += [(None, face) for face in found[c:d]]
    return [*zip(drawn, theirs, strict=True), *besides]


def _recognized(port: Port) -> list[Face]:
    """The port's faces by their corners; polygons are told apart in clip space alone."""
    name = other_faces(port)
    names = [name, *port.names("vertex")]
    quads = {n: np.asarray(port.handed[n], np.float64).reshape(-1, 4, port.handed[n].shape[1]) for n in names if n}
    count = len(quads[str(name)])
    if "vertex.clip" in quads and len(quads["vertex.clip"]) == count:
        found = [_in_clip_space(port, quad) for quad in quads["vertex.clip"]]
        if any(number >= 0 for _, number in found):
            return found
    if "vertex.patch" in quads and len(quads["vertex.patch"]) == count:
        return [_in_patch_space(port, quad) for quad in quads["vertex.patch"]]
    return [(-1, -1)] * count


def _in_clip_space(port: Port, quad: NDArray[np.float64]) -> Face:
    of = port.model.machine.of
    for polygon, quads in enumerate(port.model.quads):
        for each in quads:
            if _near(of(each.clip).value, quad):
                return polygon, each.face
    for polygon, patch in enumerate(port.model.patches):
        for number, corners in enumerate(QUADS):
            clip = [of(c) for c in port.model.program.projected(patch, list(corners.T))]
            if _near(np.stack([np.broadcast_to(c.value, 4) for c in clip], axis=1), quad):
                return polygon, number
    return -1, -1


def _in_patch_space(port: Port, quad: NDArray[np.float64]) -> Face:
    for quads in port.model.quads:
        for each in quads:
            if _near(port.model.machine.of(each.patch).value, quad):
                return -1, each.face
    return -1, next((number for number, corners in enumerate(QUADS) if _near(corners, quad)), -1)


def _near(corners: NDArray[np.float64], quad: NDArray[np.float64]) -> bool:
    if corners.shape != quad.shape:
        return False
    return bool((np.abs(corners - quad) <= NEAR * (1.0 + np.abs(corners))).all())
