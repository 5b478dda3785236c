"""`ibr-ref demo`: the papers' figures from built-in inputs."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli.progress import progress

if TYPE_CHECKING:
    from ibr_ref.displacement import Params, Scene
    from ibr_ref.io import Frame

EXAMPLES = """
Example:

    ibr-ref demo --out demo
"""


@dataclass(frozen=True)
class Picture:
    """One picture of the demo."""

    name: str
    """File name without ending."""
    caption: str
    scene: Scene
    params: Params
    hide: tuple[int, ...] = ()
    """Faces of the volume that are left out (figure 6d shows one auxiliary face alone)."""


def command(
    out: Annotated[Path, typer.Option(help="Folder for the pictures; made if it is not there.")] = Path("demo"),
) -> None:
    """Render the papers' figures from built-in inputs: pictures, a contact sheet, and times beside the papers'."""
    from rich.console import Console

    out.mkdir(parents=True, exist_ok=True)
    pictures = _figure_6() + _city()
    shown, seconds = [], []
    with progress(len(pictures) + 1) as step:
        for picture in pictures:
            step(picture.caption)
            frame, taken = _render(picture)
            frame.save(out / f"{picture.name}.png")
            shown.append((picture.caption, frame.color))
            seconds.append(taken)
        step("contact sheet")
        from ibr_ref.cli.contact_sheet import contact_sheet
        from ibr_ref.io import write_image

        write_image(out / "contact_sheet.png", contact_sheet(shown, columns=3))
    console = Console()
    console.print(_table(pictures, seconds))
    console.print(f"{len(pictures)} pictures and contact_sheet.png are in {out}{'' if str(out).endswith('/') else '/'}")


def _figure_6() -> list[Picture]:
    """The paper's figure 6 (a) to (f), on the same box."""
    from ibr_ref import displacement, models
    from ibr_ref.scene import Camera, Light

    box = models.box()
    camera = Camera.look_at(eye=(0.65, -1.3, 0.85), target=(0.0, 0.02, 0.08), near=0.05, far=10.0)
    low = displacement.Scene(
        polygons=[replace(box, facade_map=None)],
        camera=camera,
        light=Light(direction=(0.4, -0.7, 1.0)),
        background=(1.0, 1.0, 1.0),
    )
    tall = replace(low, polygons=[replace(box, facade_map=None, height_scale=2 * box.height_scale)])
    walls = replace(low, polygons=[replace(box, height_scale=2 * box.height_scale)])
    params = displacement.Params(linear_steps=50)
    base = replace(params, faces="base")
    return [
        Picture("figure_6a", "6 (a) texture mapping", low, replace(params, method="texture")),
        Picture("figure_6b", "6 (b) protruded displacement mapping", low, base),
        Picture("figure_6c", "6 (c) twice the height: the ground stays", tall, base),
        Picture("figure_6d", "6 (d) one auxiliary face", tall, params, hide=(1, 2)),
        Picture("figure_6e", "6 (e) all auxiliary faces", tall, params),
        Picture("figure_6f", "6 (f) steep walls with a facade", walls, params),
    ]


def _city() -> list[Picture]:
    """The paper's figure 15, on our own city: what each part of the method adds."""
    from ibr_ref import displacement, models
    from ibr_ref.scene import Camera, Light

    city = models.city()
    scene = displacement.Scene(
        polygons=[city],
        camera=Camera.look_at(eye=(2.1, -3.5, 1.9), target=(0.05, -0.1, 0.05), near=0.1, far=20.0),
        light=Light(direction=(-0.7, -0.5, 1.0)),
        background=(0.72, 0.82, 0.93),
    )
    plain = replace(scene, polygons=[replace(city, facade_map=None)])
    params = displacement.Params(linear_steps=100)
    return [
        Picture("figure_15a", "15 (a) texture mapping", scene, replace(params, method="texture")),
        Picture("figure_15b", "15 (b) relief mapping: the ground sinks", scene, replace(params, method="relief")),
        Picture("figure_15c", "15 (c) protruded: cut at the outline", plain, replace(params, faces="base")),
        Picture("figure_15d", "15 (d) auxiliary faces: the silhouette", plain, params),
        Picture("figure_15e", "15 (e) facades on steep walls", scene, params),
        Picture("city_shadows", "the same with self-shadow", scene, replace(params, shadow_steps=64)),
    ]


def _render(picture: Picture) -> tuple[Frame, float]:
    """The frame, and the seconds of a second, warm rendering of it."""
    from ibr_ref import displacement

    frame = displacement.render(picture.scene, picture.params, stages=bool(picture.hide))
    start = time.perf_counter()
    displacement.render(picture.scene, picture.params, stages=False)
    taken = time.perf_counter() - start
    if picture.hide:
        import numpy as np

        hidden = np.isin(frame.stages["raster.face"], picture.hide)
        color = np.where(hidden[..., None], np.asarray(picture.scene.background), frame.color)
        frame = replace(frame, color=color)
    return frame, taken


def _table(pictures: list[Picture], seconds: list[float]) -> Any:
    from rich.table import Table

    table = Table(title="Protruded displacement mapping (Yoo & Han 2006)")
    for column in ("figure", "N + M", "picture", "this machine, ms", "paper, ms"):
        table.add_column(column, justify="left" if column == "figure" else "right")
    for picture, taken in zip(pictures, seconds, strict=True):
        params, camera = picture.params, picture.scene.camera
        protruded = params.method == "protruded" and params.linear_steps == 50
        table.add_row(
            picture.caption,
            "" if params.method == "texture" else f"{params.linear_steps} + {params.binary_steps}",
            f"{camera.width} x {camera.height}",
            f"{taken * 1e3:.1f}",
            "40" if protruded else "",
        )
    table.caption = "paper: GeForce 6600GT at 640 x 480 with 50 linear steps; `ibr-ref bench` measures with more care"
    return table
