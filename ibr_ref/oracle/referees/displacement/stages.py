"""Every stage of which a port handed in an array, judged on its own inputs."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees.displacement.hits import hits_of, lighted, shades_of
from ibr_ref.oracle.referees.displacement.image import judge_picture
from ibr_ref.oracle.referees.displacement.judging import (
    Verdict,
    judge_march,
    judge_raster,
    judge_resolve,
    judge_shade,
    judge_vertex,
)
from ibr_ref.oracle.referees.displacement.replay import (
    ARRAYS,
    Port,
    light_input,
    march_input,
    raster_input,
    shade_input,
)
from ibr_ref.oracle.referees.displacement.rows import Hits, Points, Shades

START = 500
"""What setting up a program costs, in rows."""
STAGES = ("vertex", "raster", "march", "shade", "resolve")
SAMPLED = ("march", "shade", "resolve", "image")
"""Of which some elements are sooner judged than all."""


class Stages:
    """A port's stages, each computed when it is asked for; of the pixels `among` alone where the port says so."""

    def __init__(self, port: Port) -> None:
        self.port, self.model = port, port.model

    @property
    def cost(self) -> int:
        """Rows of the program that were run, forks too."""
        return START + self.model.machine.run.rows

    def take_fragments(self, other: Stages) -> None:
        """Those of a program that draws the same faces."""
        self._raster = other._raster

    def judgements(self) -> Iterator[Judgement]:
        """Of what was handed in, in pipeline order."""
        clean = True
        for stage in STAGES:
            if self.names(stage):
                judgement = self.judge(stage, clean=clean)
                clean &= stage == "shade" or not judgement.wrong.any()
                yield judgement

    def names(self, stage: str) -> tuple[str, ...]:
        """What of a stage was handed in."""
        if stage in ("resolve", "image"):
            return tuple(name for name in ("depth", "color") if name in self.port.handed)
        return self.port.names(stage)

    def judge(self, stage: str, *, clean: bool = True) -> Judgement:
        """One stage, or "image".

        clean: the geometry before it is right, so that the program's other fragments are the port's.
        """
        port = self.port
        if stage == "image":
            return judge_picture(port.picture, port.handed)
        if stage == "vertex":
            return judge_vertex(port)
        if stage == "raster":
            return _picture(port, stage, self._raster[1], judge_raster(port, self._raster[0]))
        if stage == "march":
            points, bare = self._points
            hits, lost = self._marched
            return _picture(port, stage, port.names("raster"), judge_march(port, hits, bare, points, lost))
        shown, color, lost = self._lit
        surfaces = self._surfaces
        if self._marches:
            lost = np.concatenate([lost, self._marched[1]])
        if not self._whole_shades or stage == "shade":
            lost = np.concatenate([lost, self._shades[1]])
        if stage == "shade":
            pixel = surfaces.pixel[shown]
            return _picture(
                port, stage, port.names("march"), judge_shade(port, self._hits, self._shades[0], pixel, color, lost)
            )
        verdict = judge_resolve(port, self._hits, surfaces.hit[shown], color, clean, lost)
        return _picture(port, stage, port.names("march") + port.names("shade"), verdict)

    @cached_property
    def _raster(self) -> tuple[Points, tuple[str, ...]]:
        return raster_input(self.port)

    @cached_property
    def _points(self) -> tuple[Points, Bools]:
        points, bare = march_input(self.port, self._raster[0])
        if self.port.among is not None:
            points = points.take(self.port.among[points.pixel])
        return points, bare

    @cached_property
    def _marched(self) -> tuple[Hits, Ints]:
        return hits_of(self.model, self._points[0])

    @property
    def _marches(self) -> bool:
        """Whether anything hangs on the program's own march."""
        return (bool(self.port.names("march")) and self.port.among is None) or not self.port.whole_hits

    @cached_property
    def _hits(self) -> Hits:
        hits = shade_input(self.port, None if self.port.whole_hits else self._marched[0], lambda: self._raster[0])
        return hits if self.port.among is None else hits.take(self.port.among[hits.pixel])

    @cached_property
    def _shades(self) -> tuple[Shades, Ints]:
        return shades_of(self.model, self._hits)

    @property
    def _whole_shades(self) -> bool:
        """Whether the port's own surfaces are all that lighting needs."""
        return len(self.port.names("shade")) == len(ARRAYS["shade"])

    @cached_property
    def _surfaces(self) -> Shades:
        return light_input(self.port, self._hits, None if self._whole_shades else self._shades[0])

    @cached_property
    def _lit(self) -> tuple[Ints, list[Number], Ints]:
        return lighted(self.model, self._hits, self._surfaces)


def _picture(port: Port, stage: str, replayed: tuple[str, ...], verdict: Verdict) -> Judgement:
    camera = port.case.scene.camera
    shape = (camera.height, camera.width)
    wrong = verdict.wrong if port.among is None else verdict.wrong & port.among
    return Judgement(
        stage=stage,
        element="pixel",
        arrays=verdict.arrays,
        replayed=replayed,
        wrong=wrong.reshape(shape),
        undecided=verdict.undecided.reshape(shape),
        width=verdict.width.reshape(shape),
        blame=np.where(wrong, verdict.blame, -1).astype(np.int8).reshape(shape),
    )
