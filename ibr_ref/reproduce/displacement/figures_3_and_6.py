"""Figures 3 and 6: one box, by relief mapping and by protruded displacement mapping."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ibr_ref import models
from ibr_ref.displacement import Params, Scene, render
from ibr_ref.displacement.measures import (
    EXACT,
    Mask,
    drift,
    heights_at,
    overflow,
    overlap,
    raised,
    wall_texture,
    walls,
)
from ibr_ref.io import Frame
from ibr_ref.reproduce.displacement.scenes import looking_at
from ibr_ref.reproduce.displacement.sheets import base, flat_walls, taller, without_faces, write_sheet
from ibr_ref.reproduce.findings import Claim, Found, Table, Within

PARAMS = Params(linear_steps=50)
RELIEF = replace(PARAMS, method="relief")
FINE = replace(PARAMS, linear_steps=800)


def _scene(size: tuple[int, int]) -> Scene:
    return looking_at(models.box(), (0.65, -1.3, 0.85), target=(0.0, 0.02, 0.08), size=size)


def _kept(frame: Frame) -> Mask:
    kept: Mask = frame.stages["march.hit_index"] >= 0
    return kept


def figure_3(folder: Path, within: Within, size: tuple[int, int] = (640, 480)) -> Found:
    """The ground sinks, sinks twice as far, leaves gaps, and is shrunk by tiles too."""
    scene = flat_walls(_scene(size))
    tiled = replace(scene, polygons=[replace(polygon, domain="repeat") for polygon in scene.polygons])
    within("relief mapping", 0, 1)
    a = render(scene, replace(PARAMS, method="texture"))
    b, c, d = render(scene, RELIEF), render(taller(scene, 2.0), RELIEF), render(tiled, RELIEF)
    captions = ("(a) texture mapping", "(b) relief mapping", "(c) twice the height", "(d) tiled")
    figure = write_sheet(
        folder, "figure_3", [(caption, frame.color) for caption, frame in zip(captions, (a, b, c, d), strict=True)],
        columns=2, title="Figure 3: relief mapping of a protruding shape",
        caption="640 x 480, 50 + 6 steps; the polygon is the top of the volume, and what is not raised sinks below it.",
        published="the ground's grid moves from (a) to (b) and again to (c), the border is empty; tiles fill it.",
    )  # fmt: skip
    drifts = [drift(scene, frame)[0] for frame in (a, b, c, d)]
    gaps = [1.0 - float(_kept(frame)[_kept(a)].mean()) for frame in (a, b, c, d)]
    table = Table(
        title="Figure 3 in numbers", columns=("picture", "ground's drift, pixels", "empty part of the polygon"),
        rows=tuple(zip(captions, drifts, gaps, strict=True)),
        how="Drift as in table 2, mean; empty: of the pixels that texture mapping covers.",
    )  # fmt: skip
    sinks = Claim(
        claim="Relief mapping sinks the ground, and twice as far for twice the height (figure 3 b, c).",
        published="figure 3", measured=f"drift {drifts[1]:.1f} and {drifts[2]:.1f} pixels (texture mapping {drifts[0]:.2g})",
        holds=drifts[2] > 1.5 * drifts[1] > 1.0,
    )  # fmt: skip
    shrinks = Claim(
        claim="Tiling fills the gaps at the border, but the ground shrinks as before (figure 3 d).",
        published="figure 3", measured=f"gaps {gaps[1]:.0%} without tiles, {gaps[3]:.0%} with; drift {drifts[3]:.1f} pixels",
        holds=gaps[1] > 0.05 and gaps[3] < 0.001 and drifts[3] > 0.9 * drifts[1],
    )  # fmt: skip
    return Found(figures=(figure,), tables=(table,), claims=(sinks, shrinks))


def figure_6(folder: Path, within: Within, size: tuple[int, int] = (640, 480)) -> Found:
    """What each part of protruded displacement mapping adds."""
    whole = taller(_scene(size), 2.0)
    scene, tall = flat_walls(_scene(size)), flat_walls(whole)
    within("protruded displacement mapping", 0, 1)
    a = render(scene, replace(PARAMS, method="texture"))
    b, c, e, f = base(scene, PARAMS), base(tall, PARAMS), render(tall, PARAMS), render(whole, PARAMS)
    exact, fine = render(tall, EXACT), render(tall, FINE)
    d_color = without_faces(tall, e, (1, 2))
    pictures = [
        ("(a) texture mapping", a.color), ("(b) protruded", b.color), ("(c) twice the height", c.color),
        ("(d) one auxiliary face", d_color), ("(e) all of them", e.color), ("(f) with a facade", f.color),
    ]  # fmt: skip
    figure = write_sheet(
        folder, "figure_6", pictures, title="Figure 6: protruded displacement mapping",
        caption="640 x 480, 50 + 6 steps, threshold 0.1; (d) leaves out the faces u = 0 and u = 1.",
        published="a blue box rises from the yellow ground, which stays; (c) is cut off at the polygon's outline, (d) and "
        "(e) add one face and all, (f) puts a texture on the walls.",
    )  # fmt: skip
    beside = heights_at(scene, render(scene, EXACT), radius=2) == 0.0
    ground = np.abs(b.color - a.color).max(axis=-1)[beside & _kept(a)]
    return Found(figures=(figure,), claims=_claims(tall, ground, (b, c, e, f), exact, fine, whole))


def _claims(
    tall: Scene, ground: np.ndarray, frames: tuple[Frame, Frame, Frame, Frame], exact: Frame, fine: Frame, whole: Scene
) -> tuple[Claim, ...]:
    b, c, e, f = frames
    drifts = drift(tall, b)[1], drift(tall, c)[1]
    shown = [overflow(tall, exact, frame) or 0.0 for frame in (c, e, fine)]
    outlines = [overlap(raised(tall, frame), raised(tall, exact)) for frame in (c, e, fine)]
    wall = walls(tall, exact)
    smear, cured = wall_texture(tall, e, wall)[1], wall_texture(whole, f, wall)[1]
    return (
        Claim(
            claim="The ground stays where it is, whatever the height (figure 6 b, c).",
            published="figure 6",
            measured=f"largest drift {drifts[0]:.1g} pixels, with twice the height {drifts[1]:.1g}; "
            f"{(ground < 1e-9).mean():.1%} of the pixels beside the box are those of texture mapping, but for rounding",
            holds=max(drifts) < 0.01,
        ),
        Claim(
            claim="Auxiliary faces complete the silhouette (figure 6 c to e).",
            published="figure 6",
            measured=f"overflow shown {shown[0]:.0%} without, {shown[1]:.1%} with them (N = 50), {shown[2]:.1%} with "
            f"N = 800; outline of the box against the exact one {outlines[0]:.3f}, {outlines[1]:.3f}, {outlines[2]:.4f}",
            holds=shown[2] > 0.99 and outlines[2] > 0.99,
            why="The faces leave nothing out; what is missing with N = 50 are rays that pass the box's edges by less "
            "than a linear step.",
        ),
        Claim(
            claim="Without detected walls a line of texels is stretched over the box's sides (figure 6 e, f).",
            published="figure 6",
            measured=f"smeared pixels on walls {smear:.0%}, with the facade {cured:.0%}",
            holds=cured < 0.5 * smear,
        ),
    )
