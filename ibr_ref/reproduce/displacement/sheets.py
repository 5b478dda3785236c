"""Sheets of pictures under their captions, written beside a step's findings."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ibr_ref.demo.contact_sheet import contact_sheet
from ibr_ref.displacement import Params, Scene, render
from ibr_ref.io import Frame, write_image
from ibr_ref.reproduce.findings import Figure

Pictures = list[tuple[str, NDArray[np.float64]]]


def write_sheet(
    folder: Path, name: str, pictures: Pictures, *, title: str, caption: str, published: str, columns: int = 3
) -> Figure:
    """Write the sheet as `name`.png; its record."""
    write_image(folder / f"{name}.png", contact_sheet(pictures, columns))
    return Figure(title=title, file=f"{name}.png", caption=caption, published=published)


def flat_walls(scene: Scene) -> Scene:
    """The scene without facades."""
    return replace(scene, polygons=[replace(polygon, facade_map=None) for polygon in scene.polygons])


def taller(scene: Scene, factor: float) -> Scene:
    """The scene with so many times the height."""
    polygons = [replace(polygon, height_scale=factor * polygon.height_scale) for polygon in scene.polygons]
    return replace(scene, polygons=polygons)


def without_faces(scene: Scene, frame: Frame, faces: tuple[int, ...]) -> NDArray[np.float64]:
    """The picture without what these faces of the volume show."""
    hidden = np.isin(frame.stages["raster.face"], faces)
    return np.where(hidden[..., None], np.asarray(scene.background), frame.color)


def base(scene: Scene, params: Params) -> Frame:
    """Protruded mapping on the polygon alone."""
    return render(scene, replace(params, faces="base"))
