"""Tables 1 and 2: frames and points a second."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import NamedTuple

from ibr_ref import jit, splatting
from ibr_ref.bench.splatting import PAPER_MPPS, scenes
from ibr_ref.bench.times import best_and_median
from ibr_ref.reproduce.findings import Cell, Claim, Found, Table, Within
from ibr_ref.reproduce.splatting.systems import System, photographs, systems
from ibr_ref.scene import Light
from ibr_ref.splatting import Params, Scene

PAPER_FPS = {
    "rig of 4": (559.84, 94.17, 14.59),
    "rig of 9": (310.18, 50.96, 7.89),
    "rig of 16": (152.32, 25.25, 3.93),
    "1 reference": (33.7, 5.44, 0.85),
    "4 references": (8.29, 1.35, 0.22),
    "8 references": (4.78, 0.78, 0.12),
}
"""Frames a second with shaders, fixed-function OpenGL and in software: tables 1 and 2."""

COLUMNS = ("Shader", "OpenGL", "Software")
REPEAT = {1: 10, 2: 3}
"""Frames of each kind, by table."""


class Timed(NamedTuple):
    """A row."""

    images: str
    points: int
    system: System
    best: float
    median: float

    @property
    def mpps(self) -> float:
        """Million points a second, of the best frame."""
        return self.points / self.best / 1e6


def run(folder: Path, within: Within) -> Found:
    """Both tables."""
    data = photographs()
    rows: list[Timed] = []
    for name, scene, fit in scenes(data):
        rows += timed(name, scene, fit, REPEAT[_table_of(name)], within)
    return Found(tables=_tables(rows, data is not None), claims=_claims(rows))


def _table_of(images: str) -> int:
    return 1 if images.startswith("rig") else 2


def timed(images: str, scene: Scene, fit: Params, repeat: int, within: Within) -> list[Timed]:
    """The frames of all systems, without stages; a scene without a light gets one at the eye."""
    lit = replace(scene, light=scene.light or Light(position=scene.camera.eye[:3], specular=0.3))
    points = sum(int(image.arrays[2].sum()) for image in scene.images)
    rows, compared = [], systems(lit, fit)
    for done, system in enumerate(compared):
        within(f"{images}: {system.name}", done, len(compared))
        best, middle = best_and_median(lambda: splatting.render(system.scene, system.params, stages=False), repeat)  # noqa: B023
        rows.append(Timed(images, points, system, best, middle))
    return rows


def _tables(rows: Sequence[Timed], photographed: bool) -> tuple[Table, ...]:
    real = "Breakdancers, its two published cameras in turn" if photographed else "hills made by formula"
    notes = (
        "The kettle's references have the paper's numbers of points to 1 %.",
        f"In place of Ballet, of which no file is published alone: {real}, with as many points, and a light at the eye.",
    )
    titles = ("Table 1: rendering speed, synthetic data", "Table 2: rendering speed, real data")
    return tuple(
        Table(
            title=titles[i],
            columns=(
                "references",
                "points",
                "system",
                "ms, best",
                "ms, median",
                "FPS",
                "MPPS",
                "paper FPS",
                "paper MPPS",
            ),
            rows=tuple(_row(row) for row in rows if _table_of(row.images) == i + 1),
            how=f"Whole frames of 640 x 480 (table 2: 1024 x 768) with warm kernels, no stages, the best and the median of "
            f"{REPEAT[i + 1]} by the function that `ibr-ref bench` times with; {jit.threads()} threads, the loop one. "
            "FPS and MPPS (million points a second) are those of the best frame.",
            note=notes[i] + " The paper's are a GeForce 7800GTX and an Athlon 64 of 2 GHz.",
        )
        for i in range(2)
    )


def _row(row: Timed) -> tuple[Cell, ...]:
    column = COLUMNS.index(row.system.paper) if row.system.paper else None
    fps, mpps = (None if column is None else paper[row.images][column] for paper in (PAPER_FPS, PAPER_MPPS))
    label = f"{row.system.name} ({row.system.paper})" if row.system.paper else row.system.name
    times = (_milliseconds(row.best), _milliseconds(row.median))
    return row.images, row.points, label, *times, 1.0 / row.best, row.mpps, fps, mpps


def _milliseconds(seconds: float) -> Cell:
    """Whole ones from a second on, which the page would write with an exponent."""
    return 1e3 * seconds if seconds < 1.0 else round(1e3 * seconds)


def _claims(rows: Sequence[Timed]) -> tuple[Claim, ...]:
    software = _ratios(rows, "Software")
    opengl = _ratios(rows, "OpenGL")
    shader = [row.mpps for row in rows if row.system.paper == "Shader"]
    return (
        Claim(
            claim="Rendering is considerably faster than in software.",
            published="38 to 40 times",
            measured=f"{_span(software)} times, {median(software):.1f} in the middle",
            holds=median(software) >= 2.0,
            why="Both run on the CPU here: what is left is threads, lanes, and that only points which are seen are lit. The "
            "paper's factor is that of its GPU.",
        ),
        Claim(
            claim="It is more than six times faster than OpenGL's points of constant size.",
            published="5.9 to 6.2 times",
            measured=f"{_span(opengl)} times",
            holds=min(opengl) >= 5.9,
            why="On one machine, points of a constant size with baked light are less work than a law and Phong. The paper's "
            "4.2 million points a second are those of points handed over by the CPU, one by one.",
        ),
        Claim(
            claim="Points a second do not depend on the number of references.",
            published="25.2 to 30.0 MPPS",
            measured=f"{min(shader):.1f} to {max(shader):.1f} MPPS",
            holds=max(shader) <= 1.25 * min(shader),
            why="Small references cost a kernel call each, and a picture of 640 x 480 its own pixels, whatever the points.",
        ),
    )


def _ratios(rows: Iterable[Timed], paper: str) -> list[float]:
    """How many times longer than the fitted law's a system's best frame takes, for each set of references."""
    best = {(row.images, row.system.paper): row.best for row in rows}
    return [seconds / best[images, "Shader"] for (images, name), seconds in best.items() if name == paper]


def _span(values: Sequence[float]) -> str:
    return f"{min(values):.1f} to {max(values):.1f}"
