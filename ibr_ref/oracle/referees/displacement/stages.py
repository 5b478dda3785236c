"""Every stage of which a port handed in an array, judged on its own inputs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement.contract import STAGES
from ibr_ref.oracle.accept.bounded import Bounded, exact, uploaded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.displacement.arrays import joined
from ibr_ref.oracle.referees.displacement.drawn_faces import judge_faces, other_faces
from ibr_ref.oracle.referees.displacement.hits import Hits, hits_of
from ibr_ref.oracle.referees.displacement.image import judged
from ibr_ref.oracle.referees.displacement.raster import Fragments
from ibr_ref.oracle.referees.displacement.replay import (
    Port,
    light_input,
    march_field,
    march_input,
    not_covered,
    raster_field,
    raster_input,
    shade_field,
    shade_input,
)
from ibr_ref.oracle.referees.displacement.shown import Shades, lighted, shades_of

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True, eq=False)
class Verdict:
    """Elements of one stage, flat: what `Judgement` holds, before it has the picture's shape."""

    arrays: tuple[str, ...]
    wrong: Bools
    undecided: Bools
    width: NDArray[np.float64]
    blame: NDArray[np.int8]


def judgements(case: Case, device: Device, handed: Handed) -> Iterator[Judgement]:
    """In pipeline order, each computed when it is asked for."""
    port = Port(case=case, device=device, handed=handed)
    before_shade: list[Judgement] = []
    if port.names("vertex"):
        before_shade.append(_vertex(port))
        yield before_shade[-1]
    candidates, replayed = raster_input(port)
    if port.names("raster"):
        before_shade.append(_picture(port, "raster", replayed, _raster(port, candidates)))
        yield before_shade[-1]
    fragments, bare = march_input(port, candidates)
    hits, lost = hits_of(port.constants, case.params, fragments)
    if port.names("march"):
        verdict = _march(port, hits, bare, fragments, lost)
        before_shade.append(_picture(port, "march", port.names("raster"), verdict))
        yield before_shade[-1]
    hits = shade_input(port, hits)
    shades = shades_of(port.constants, case.params, hits)
    surfaces = light_input(port, hits, shades)
    shown, color = lighted(port.constants, hits, surfaces)
    if port.names("shade"):
        verdict = _shade(port, hits, shades, hits.pixel[surfaces.hit[shown]], color, lost)
        yield _picture(port, "shade", port.names("march"), verdict)
    if port.has("color") or port.has("depth"):
        clean = not any(judgement.wrong.any() for judgement in before_shade)
        verdict = _resolve(port, hits, surfaces.hit[shown], color, clean, lost)
        yield _picture(port, "resolve", port.names("march") + port.names("shade"), verdict)


def _picture(port: Port, stage: str, replayed: tuple[str, ...], verdict: Verdict) -> Judgement:
    camera = port.case.scene.camera
    shape = (camera.height, camera.width)
    return Judgement(
        stage=stage,
        element="pixel",
        arrays=verdict.arrays,
        replayed=replayed,
        wrong=verdict.wrong.reshape(shape),
        undecided=verdict.undecided.reshape(shape),
        width=verdict.width.reshape(shape),
        blame=np.where(verdict.wrong, verdict.blame, -1).astype(np.int8).reshape(shape),
    )


def _vertex(port: Port) -> Judgement:
    if other_faces(port):
        return judge_faces(port)
    faces = port.candidates.faces
    legal = {"vertex.clip": joined([f.clip for f in faces]), "vertex.patch": joined([f.patch for f in faces])}
    names = port.names("vertex")
    count = len(legal["vertex.clip"].value)
    wrong, blame = np.zeros(count, np.bool_), np.full(count, -1, np.int8)
    for i, name in enumerate(names):
        found = np.asarray(port.handed[name], np.float64)
        off = ~legal[name].allows(found).all(axis=1)
        blame[off & ~wrong] = i
        wrong |= off
    width = 2.0 * np.max([np.broadcast_to(b.error, b.value.shape).max(axis=1) for b in legal.values()], axis=0)
    nowhere = np.zeros(count, np.bool_)
    return Judgement(
        stage="vertex", element="vertex", arrays=names, wrong=wrong, undecided=nowhere, width=width, blame=blame
    )


def _judged(
    port: Port, names: Sequence[str], pixel: Ints, fields: Sequence[Bounded | Ints | Bools], bare: Ints
) -> tuple[Bools, NDArray[np.int8]]:
    """Outcomes at `pixel` with these fields, and besides nothing at the pixels `bare`."""
    agrees = []
    for name, field in zip(names, fields, strict=True):
        nothing = STAGES[name].blank
        if isinstance(field, Bounded):
            shape = (len(bare), *field.value.shape[1:])
            none: Bounded | Ints = exact(np.full(shape, nothing), port.device)
        else:
            none = np.full(len(bare), int(nothing))
        agrees.append(np.concatenate([port.agreement(name, pixel, field), port.agreement(name, bare, none)]))
    right, blame = judged(np.concatenate([pixel, bare]), agrees, port.pixels)
    return ~right, blame


def _width(pixels: int, pixel: Ints, fields: Sequence[Bounded | Ints | Bools]) -> NDArray[np.float64]:
    """(pixels,) of the widest of the continuous results; NaN where there is none."""
    result = np.full(pixels, -np.inf)
    for field in fields:
        if isinstance(field, Bounded) and len(pixel):
            error = np.broadcast_to(field.error, field.value.shape)
            np.maximum.at(result, pixel, 2.0 * (error if error.ndim == 1 else error.max(axis=1)))
    return np.where(np.isfinite(result), result, np.nan)


def _several(pixels: int, pixel: Ints) -> Bools:
    """(pixels,) where there is more than one outcome."""
    return np.asarray(np.bincount(pixel, minlength=pixels) > 1, np.bool_)


def _raster(port: Port, candidates: Fragments) -> Verdict:
    names = port.names("raster")
    fields = [raster_field(candidates, name) for name in names]
    open_ = not_covered(candidates, port.pixels)
    wrong, blame = _judged(port, names, candidates.pixel, fields, np.flatnonzero(open_))
    perhaps = np.zeros(port.pixels, np.bool_)
    perhaps[candidates.pixel] = True
    return Verdict(
        arrays=names,
        wrong=wrong,
        undecided=perhaps & open_,
        width=_width(port.pixels, candidates.pixel, fields),
        blame=blame,
    )


def _march(port: Port, hits: Hits, bare: Bools, fragments: Fragments, lost: Ints) -> Verdict:
    names = port.names("march")
    fields = [march_field(hits, name) for name in names]
    wrong, blame = _judged(port, names, hits.pixel, fields, np.flatnonzero(bare))
    known = bare.copy()
    known[fragments.pixel] = True
    least, most = np.full(port.pixels, np.inf), np.full(port.pixels, -np.inf)
    np.minimum.at(least, hits.pixel, hits.hit_index.astype(np.float64))
    np.maximum.at(most, hits.pixel, hits.hit_index.astype(np.float64))
    undecided = most - least > 1
    wrong[lost], undecided[lost] = False, True
    width = _width(port.pixels, hits.pixel, fields)
    return Verdict(arrays=names, wrong=wrong & known, undecided=undecided, width=width, blame=blame)


def _shade(port: Port, hits: Hits, shades: Shades, lit_pixel: Ints, color: Bounded, lost: Ints) -> Verdict:
    names = port.names("shade")
    pixel = hits.pixel[shades.hit]
    fields = [shade_field(shades, name) for name in names]
    discarded = _discarded(port, hits)
    wrong, blame = _judged(port, names, pixel, fields, np.flatnonzero(discarded))
    judged_here = discarded.copy()
    judged_here[hits.pixel] = True
    wrong &= judged_here
    if "color" in port.handed:
        found = np.asarray(port.handed["color"]).reshape(port.pixels, 3)
        agrees = np.asarray(allows_color(color, found[lit_pixel]).all(axis=1))
        bright, _ = judged(lit_pixel, [agrees], port.pixels)
        unseen = np.ones(port.pixels, np.bool_)
        unseen[lit_pixel] = False
        unseen[hits.pixel[hits.depth.high >= 1.0]] = True
        dark = ~(bright | unseen)
        blame[dark & ~wrong] = len(names)
        wrong = wrong | dark
        names = (*names, "color")
    wrong[lost] = False
    return Verdict(
        arrays=names,
        wrong=wrong,
        undecided=_several(port.pixels, pixel),
        width=_width(port.pixels, pixel, fields),
        blame=blame,
    )


def _discarded(port: Port, hits: Hits) -> Bools:
    """(pixels,) that have no hit by the port's own account, or by the reference's where it gave none."""
    if "march.hit_index" in port.handed:
        return port.ints("march.hit_index") < 0
    result = np.ones(port.pixels, np.bool_)
    result[hits.pixel] = False
    return result | port.candidates.empty


def _resolve(port: Port, hits: Hits, lit: Ints, color: Bounded, clean: bool, lost: Ints) -> Verdict:
    """Depth, what is shown where polygons hide one another, and the background.

    Which polygon wins hangs on fragments that the port did not hand in. They are the reference's only where the port's own
    stages are right: `clean`. The colours of what is shown were judged with shade; they count here where it was not.
    """
    names = tuple(name for name in ("depth", "color") if name in port.handed)
    nothing = _discarded(port, hits)
    nothing[hits.pixel[hits.depth.high >= 1.0]] = True
    bare = np.flatnonzero(nothing & port.candidates.empty if clean else nothing)
    may_win = hits.depth.low < 1.0
    if clean:
        may_win &= _may_win(port, hits)
    entry = lit[may_win[lit]] if "color" in names and not port.names("shade") else np.flatnonzero(may_win)
    pixel = np.concatenate([hits.pixel[entry], bare])
    agrees = []
    if "depth" in names:
        depth = joined([hits.depth[entry], exact(np.ones(len(bare)), port.device)]).widened(port.device.depth_step)
        agrees.append(port.agreement("depth", pixel, depth))
    if "color" in names:
        found = np.asarray(port.handed["color"]).reshape(port.pixels, 3)
        background = uploaded(np.broadcast_to(np.asarray(port.case.scene.background), (len(bare), 3)), port.device)
        judged_before: Bools = np.ones(len(entry), np.bool_)
        if not port.names("shade"):
            judged_before = np.asarray(allows_color(color[may_win[lit]], found[hits.pixel[entry]]).all(axis=1))
        agrees.append(np.concatenate([judged_before, allows_color(background, found[bare]).all(axis=1)]))
    right, blame = judged(pixel, agrees, port.pixels)
    known = np.zeros(port.pixels, np.bool_)
    known[hits.pixel] = True
    known |= nothing
    wrong = ~right & known
    wrong[lost] = False
    wrong[port.candidates.lost] = False
    return Verdict(
        arrays=names,
        wrong=wrong,
        undecided=_several(port.pixels, pixel),
        width=_width(port.pixels, hits.pixel, [hits.depth]),
        blame=blame,
    )


def _may_win(port: Port, hits: Hits) -> Bools:
    """Which hits are of a polygon that the depth test may leave at its pixel."""
    found, count = port.candidates, len(port.constants)
    winners = found.hits.take(found.possible & found.hits.kept)
    return np.isin(hits.pixel * count + hits.polygon, np.unique(winners.pixel * count + winners.polygon))
