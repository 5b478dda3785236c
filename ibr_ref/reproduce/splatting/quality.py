"""Holes, overdraw and decibels of the systems: the photographs, and a near view of a few references."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref import models, splatting
from ibr_ref.io import read_msr, write_image
from ibr_ref.metrics import psnr
from ibr_ref.reproduce.findings import Cell, Claim, Figure, Found, Table, Within
from ibr_ref.reproduce.splatting.canvas import cropped, enlarged, side_by_side
from ibr_ref.reproduce.splatting.systems import constant, fitted, hand_set, photographs
from ibr_ref.scene import Camera, DepthImage
from ibr_ref.splatting import Coverage, Params, Scene

COLUMNS = ("system", "coverage", "holes, %", "overdraw", "dB, covered", "dB, all", "dB, covered by all systems")

SHOWN = ("constant 1 pixel", "law, fitted", "elliptical weighted averages")


class Drawn(NamedTuple):
    """A system's picture."""

    name: str
    color: NDArray[np.float64]
    found: Coverage


def run(folder: Path, within: Within) -> Found:
    """The two tables, and a part of the pictures of each."""
    tables, figures, claims = [], [], []
    for key, scene, truth, words in (_real(), _near()):
        pictures = drawn(scene, within)
        rows = measured(pictures, truth.arrays[0])
        tables.append(
            Table(
                title=f"Holes, overdraw and decibels: {words}",
                columns=COLUMNS,
                rows=tuple(rows),
                how="A hole is a pixel inside the projected quads of neighbouring reference pixels that no splat covers; "
                "overdraw is splats a covered pixel; decibels are over RGB, against the picture taken from the same place.",
                note="More coverage adds pixels that are hard, beside what the reference saw: the last column compares all "
                "systems on the same pixels.",
            )
        )
        write_image(folder / f"{key}.png", _parts(pictures, truth.arrays[0], *_WINDOWS[key]))
        figures.append(
            Figure(
                title=f"Splats close up: {words}",
                file=f"{key}.png",
                caption="A part of the picture, every pixel enlarged: the truth, then " + ", ".join(SHOWN) + ".",
            )
        )
        claims.append(_claim(words, rows))
    return Found(tables=tuple(tables), figures=tuple(figures), claims=tuple(claims))


_WINDOWS = {"photographs": (400, 300, 120, 120), "near": (230, 150, 120, 120)}
"""Column, row, width and height of the part that is shown."""


def _real() -> tuple[str, Scene, DepthImage, str]:
    """Camera 1's view from camera 0's picture; without the photographs, of the horse from two places as near."""
    data = photographs()
    if data is not None:
        first, second = read_msr(data, cameras=(0, 1))
        words = "Breakdancers, camera 1 from camera 0"
    else:
        first, second = (models.depth_image(models.horse(), _stand(x)) for x in (1.2, 1.7))
        words = "the horse, from a picture half a metre beside it (the photographs are not here)"
    return "photographs", Scene(images=[first], camera=second.camera, light=None), second, words


def _stand(x: float) -> Camera:
    eye = (x, -4.0, 2.0)
    return Camera.look_at(eye=eye, target=(0, 0, 1), vertical_fov=38, near=1, far=20, width=1024, height=768)


def _near() -> tuple[str, Scene, DepthImage, str]:
    """Close to a rig of four: what the law is for."""
    view = Camera.look_at(eye=(1.0, -1.15, 1.15), target=(0.15, 0, 0.5), near=0.05, far=10, width=640, height=480)
    images = models.depth_rig(models.kettle(), 4, size=210)
    truth = models.depth_image(models.kettle(), view)
    return "near", Scene(images=images, camera=view, light=None), truth, "close to the kettle, a rig of 4"


def choices(scene: Scene) -> list[tuple[str, Params]]:
    """The systems by name; the loop in software draws the fitted law's picture, bit for bit."""
    fit = fitted(scene.images, scene.camera)
    return [
        *((f"constant {width} pixel{'s' if width > 1 else ''}", constant(width)) for width in (1, 2, 3)),
        ("law, set by hand", hand_set(scene.images, scene.camera)),
        ("law, fitted", fit),
        ("law, fitted, discs", replace(fit, shape="disc")),
        ("elliptical weighted averages", Params(shape="ellipse")),
    ]


def drawn(scene: Scene, within: Within) -> list[Drawn]:
    """The pictures of all systems; where the surface is known is the same for all."""
    pictures: list[Drawn] = []
    wanted = choices(scene)
    for done, (name, params) in enumerate(wanted):
        within(name, done, len(wanted))
        frame = splatting.render(scene, params)
        if not pictures:
            found = splatting.coverage(scene, frame)
        else:
            stages = frame.stages
            found = found._replace(covered=stages["raster.splat"] >= 0, overdraw=stages["raster.overdraw"])
        pictures.append(Drawn(name, frame.color, found))
    return pictures


def measured(pictures: Sequence[Drawn], truth: NDArray[np.float64]) -> list[tuple[Cell, ...]]:
    """Rows of the table."""
    everywhere = np.ones(truth.shape[:2], np.bool_)
    common = np.logical_and.reduce([picture.found.covered for picture in pictures])
    return [
        (
            name,
            found.coverage,
            100.0 * found.hole_share,
            found.mean_overdraw,
            *(psnr(color, truth, where) for where in (found.covered, everywhere, common)),
        )
        for name, color, found in pictures
    ]


def _parts(pictures: Sequence[Drawn], truth: NDArray[np.float64], *window: int) -> NDArray[np.float64]:
    shown = [truth] + [picture.color for picture in pictures if picture.name in SHOWN]
    return side_by_side([enlarged(cropped(color, *window), 3) for color in shown])


def _claim(words: str, rows: Sequence[tuple[Cell, ...]]) -> Claim:
    """Whether there are better shapes than the paper's squares, which it leaves open."""
    by_name = {str(row[0]): row for row in rows}
    law, ellipse = by_name["law, fitted"], by_name["elliptical weighted averages"]
    gain = float(ellipse[6] or 0.0) - float(law[6] or 0.0)
    return Claim(
        claim=f"The shape and size of splats can be optimized further ({words}).",
        published="future work (section 5)",
        measured=f"{gain:+.2f} dB by elliptical weighted averages on the same pixels; holes {law[2]:.2g} % by the law, "
        f"{ellipse[2]:.2g} % by ellipses",
        holds=gain > 0.0,
        why="Ellipses follow the surface, and averages anti-alias; they are drawn in two passes.",
    )
