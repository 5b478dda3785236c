"""Figures 4, 7, 8 and 9 to 12, and one that the paper has not: soft shadows side by side."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from ibr_ref import io, models, shadows
from ibr_ref.array_types import Floats
from ibr_ref.demo.shadows import difference, warped_and_rendered
from ibr_ref.reproduce.findings import Figure, Found, Within
from ibr_ref.reproduce.shadows.objects import objects, which
from ibr_ref.scene import Camera
from ibr_ref.shadows import Maps, Params, Scene, SoftParams

OFFSET = (0.23, -0.31)
"""Between the nine places."""
PLACES = 5
"""Of figure 4, on either axis."""
SAMPLES = (1, 5, 9)
PLACEMENT = "best"
"""Of the control points."""


@cache
def _warping(name: str) -> tuple[Scene, Params, Maps]:
    """An object on its stage; maps for nine samples, and so for fewer."""
    scene = models.shadow_stage(objects()[name], offset=OFFSET)
    params = Params(light_samples=9)
    return scene, params, shadows.prepare(scene, params, controls=PLACEMENT)


def _close_up(scene: Scene) -> Scene:
    """The shadow of what stands at OFFSET, large in a picture of 320 x 240."""
    camera = Camera.look_at(
        eye=(1.2, -3.0, 2.6),
        target=(0.42, -0.4, -0.5),
        up=(0, 0, 1),
        vertical_fov=14.0,
        near=0.1,
        far=30.0,
        width=320,
        height=240,
    )
    return replace(scene, camera=camera)


def _names() -> tuple[str, str]:
    """The teapot and the cow, or what stands for them."""
    first, _, last = objects()
    return first, last


def _grey(shadow: Floats) -> Floats:
    """(H, W, 3) dark on white."""
    return np.asarray((1.0 - 0.85 * np.clip(shadow, 0.0, 1.0))[..., None].repeat(3, axis=2))


def _row(pictures: list[Floats]) -> Floats:
    """Pictures of one height beside each other, light lines between."""
    gap = np.full((len(pictures[0]), 8, 3), 0.9)
    return np.concatenate([part for picture in pictures for part in (gap, picture)][1:], axis=1)


def figure_4(folder: Path, within: Within) -> Found:
    """Maps by the object's place."""
    name = _names()[0]
    scene = models.shadow_stage(objects()[name])
    params = Params(map_size=128, map_samples=4, method="direct")
    (x0, x1), (y0, y1) = np.asarray(scene.offset_range).tolist()
    lines = []
    for j, y in enumerate(np.linspace(y1, y0, PLACES)):
        within("maps of figure 4", j, PLACES)
        at = [replace(scene, offset=(x, y)) for x in np.linspace(x0, x1, PLACES)]
        lines.append(_row([_grey(shadows.shadow_maps(one, params)[0]) for one in at]))
    gap = np.full((8, lines[0].shape[1], 3), 0.9)
    io.write_image(folder / "figure_4.png", np.concatenate([part for line in lines for part in (gap, line)][1:]))
    caption = (
        f"Maps of the {name} at {PLACES} x {PLACES} places of its range, 128², coverage of 4 x 4 samples. {which()}"
    )
    return Found(
        figures=(
            Figure(
                title="Figure 4: shadow maps by the object's place",
                file="figure_4.png",
                caption=caption,
                published="a table of shadow maps, one for each place of the object.",
            ),
        )
    )


def figure_7(folder: Path, within: Within) -> Found:
    """Warped and rendered."""
    figures = []
    for i, name in enumerate(_names()):
        within(f"warped and rendered: {name}", i, 2)
        scene, params, maps = _warping(name)
        file = f"figure_7_{name}.png"
        io.write_image(folder / file, warped_and_rendered(scene, replace(params, light_samples=1), maps))
        figures.append(
            Figure(
                title=f"Figure 7: warped and rendered, the {name}",
                file=file,
                caption="Above the warped map, in the middle the rendered one, below where they differ: red only the first, "
                f"blue only the second. 512², 15 x 5 control points, at {OFFSET}, between the nine places.",
                published="a rendered shadow and a warped one, all but equal.",
            )
        )
    return Found(figures=tuple(figures))


def figure_8(folder: Path, within: Within) -> Found:
    """Samples added with alpha."""
    within("figure 8", 0, 1)
    scene, params, maps = _warping(_names()[1])
    parts = []
    for count in SAMPLES:
        eight_bits = replace(params, light_samples=count, accumulation="unorm8")
        frame = shadows.render(_close_up(scene), eight_bits, maps=maps)
        parts.append(_grey(frame.stages["accumulate.shadow"]))
    io.write_image(folder / "figure_8.png", _row(parts))
    return Found(
        figures=(
            Figure(
                title="Figure 8: samples of the light, accumulated",
                file="figure_8.png",
                caption="1, 5 and 9 warped maps added with alpha 1/N in an 8-bit frame buffer, from near.",
                published="the soft shadow that several shadows add up to.",
            ),
        )
    )


def figures_9_to_12(folder: Path, within: Within) -> Found:
    """Hard and soft shadows in the picture."""
    figures = []
    (teapot, cow), number = _names(), 9
    for name, counts in ((teapot, (1, 9)), (cow, (1, 9))):
        for count in counts:
            within(f"figure {number}", number - 9, 4)
            scene, params, maps = _warping(name)
            frame = shadows.render(scene, replace(params, light_samples=count), maps=maps, stages=False)
            file, kind = f"figure_{number}.png", "hard" if count == 1 else "soft"
            frame.save(folder / file)
            figures.append(
                Figure(
                    title=f"Figure {number}: {kind} shadow of the {name}",
                    file=file,
                    caption=f"Warped maps of 512², 15 x 5 control points, samples of the light: {count}; 640 x 480.",
                    published=f"a {kind} shadow of the {'teapot' if name == teapot else 'cow'}.",
                )
            )
            number += 1
    return Found(figures=tuple(figures))


def soft_side_by_side(folder: Path, within: Within) -> Found:
    """Every way to a soft shadow."""
    name = _names()[1]
    stage, nine, maps = _warping(name)
    scene = _close_up(stage)
    soft: dict[str, Floats] = {}
    for i, method in enumerate(("traced", "convolution")):
        within(f"{method}, the {name}", i, 5)
        soft[method] = shadows.render_soft(scene, SoftParams(method=method)).stages["soft.shadow"]
    within(f"pcss, the {name}", 2, 5)
    soft["pcss"] = shadows.render(scene, Params(method="pcss")).stages["accumulate.shadow"]
    for i, (method, made) in enumerate({"direct": None, "warp": maps}.items()):
        within(f"{method}, nine samples, the {name}", i + 3, 5)
        frame = shadows.render(scene, replace(nine, method=method), maps=made)
        soft[method] = frame.stages["accumulate.shadow"]
    truth = soft.pop("traced")
    order = [soft[method] for method in ("direct", "warp", "convolution", "pcss")]
    above = _row([_grey(shadow) for shadow in (truth, *order)])
    below = _row([np.ones((*truth.shape, 3)), *(_amplified(shadow, truth) for shadow in order)])
    gap = np.full((8, above.shape[1], 3), 0.9)
    io.write_image(folder / "soft.png", np.concatenate([above, gap, below]))
    return Found(
        figures=(
            Figure(
                title="Beyond the paper: five ways to a soft shadow",
                file="soft.png",
                caption="From the left: the area light by 610 rays a point; nine rendered maps; nine warped maps; Soler and "
                "Sillion's convolution of one map; percentage-closer soft shadows of one map. Below the difference from the "
                "first, four times as large: red too dark, blue too light.",
            ),
        )
    )


def _amplified(ours: Floats, theirs: Floats) -> Floats:
    """Four times the difference."""
    excess = 4.0 * (ours - theirs)
    return difference(np.clip(excess, 0.0, 1.0), np.clip(-excess, 0.0, 1.0))
