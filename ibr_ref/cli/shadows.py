"""`ibr-ref render shadows`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.choices import MAPPED, SHADOWED_BY, SOFT
from ibr_ref.cli import (
    depth_set_options,
    emptiness,
    options,
    own_case,
    pictures,
    shadows_drawing,
    shadows_maps,
    shadows_several,
    shadows_stage,
)
from ibr_ref.cli.command import given
from ibr_ref.cli.described import Described, beside
from ibr_ref.cli.groups import grouped
from ibr_ref.cli.what_goes_with_what import GIVEN, Beside, always
from ibr_ref.methods import named
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.shadows import Ensemble

EXAMPLES = """
Examples:

    ibr-ref render shadows --out horse.png

    ibr-ref render shadows --caster cow.obj --samples 9 --offset 0.3,-0.2 --out cow.png

    ibr-ref render shadows --light 2,1,4 --light-size 0.3,0.1 --samples 9 --out horse.png

    ibr-ref render shadows --caster cow.obj --method pcss --light-size 0.3 --report --out cow.png

    ibr-ref render shadows --caster cow.obj --controls best --maps cow.npz --samples 9 --report --out cow.png
"""


@dataclass(frozen=True, kw_only=True)
class View:
    """Options: the camera."""

    eye: Annotated[
        options.Vector,
        typer.Option(parser=options.vector, metavar="X,Y,Z", help="The eye; z is up, the floor is at -0.5."),
    ] = options.Vector(1.4, -3, 2.1)
    target: Annotated[options.Vector, typer.Option(parser=options.vector, metavar="X,Y,Z", help="Point looked at.")] = (
        options.Vector(0.15, 0.35, -0.1)
    )
    near: options.Near = None
    far: options.Far = None
    size: Annotated[options.Size, typer.Option(parser=options.size, metavar="WxH", help="Pixels of the picture.")] = (
        options.Size(640, 480)
    )


@grouped
def read(
    context: typer.Context,
    stage: shadows_stage.Stage,
    making: shadows_maps.Making,
    view: View,
    *,
    within: Callable[[str, int, int], None] | None = None,
    case: Path | None = None,
) -> Described:
    """What the options describe, and the maps; within: told how far these are. Several casters or lights are an Ensemble.

    case: a folder for the case of it, which the oracle has for one of each alone: said before maps are prepared.

    Raises ValueError and OSError for what makes no scene.
    """
    from ibr_ref import shadows

    shadows_maps.check_writable(making)
    ensemble = _ensemble(stage, view)
    several = len(ensemble.pairs) > 1 or bool(stage.light_power)
    if several:
        shadows_several.check_goes_with(ensemble, _of_one_alone(making, case))
    first, method = ensemble.scene(0, 0), making.method
    scene = ensemble if several else first
    if method in SOFT:
        soft = shadows.SoftParams(method=str(method), map_size=making.map_size, map_samples=making.map_samples)
        return Described(first, soft, {})
    params, maps = shadows_maps.params(making, stage.samples, given(context))
    if method != "warp":
        return Described(scene, params, {})
    if several:
        made = shadows.prepare_ensemble(ensemble, params, controls=str(making.controls), progress=within)
        return Described(scene, params, {"maps": made})
    return Described(scene, params, {"maps": maps or shadows_maps.prepared(first, params, making, within)})


def _ensemble(stage: shadows_stage.Stage, view: View) -> Ensemble:
    """All that is there, and the camera."""
    width, height = view.size
    return shadows_stage.ensemble(
        stage, eye=view.eye, target=view.target, width=width, height=height, near=view.near, far=view.far
    )


def _of_one_alone(making: shadows_maps.Making, case: Path | None) -> dict[str, object]:
    """What goes with one caster and one light alone: options with their values."""
    method = making.method
    return {
        f"--method {method}": method in (*SOFT, "pcss"),
        f"--maps {making.maps}": making.maps,
        f"--case {case}": case,
    }


@beside(read)
def command(
    *,
    report: Annotated[
        bool,
        typer.Option(
            "--report", help="Print how far the shadow is from the rendered or traced one, and the maps' memory."
        ),
    ] = False,
    picture: pictures.Picture,
    depth_set: depth_set_options.OneDepthImage = None,
    kept: pictures.Kept,
    **described: Any,
) -> None:
    """Shadows by image warping (Kang & Ihm 2002) of meshes that move over a floor with steps, under one light or several."""
    wanted = pictures.Wanted(picture, kept, fov=40.0, whole={"report": report, "depth_set": depth_set})
    with progress(3) as step:
        step("reading the mesh, preparing maps")
        from ibr_ref import shadows

        wanted.check(described["size"])
        scene, params, inputs, _ = read(**described, within=step.within, case=kept.case)
        drawing = _drawing(scene, params, inputs.get("maps"), wanted.in_bands)
        keep, near, far = report or kept.stages is not None, described["near"], described["far"]
        shown, frame = pictures.draw(
            wanted,
            scene,
            params,
            lambda scene, **rows: drawing.render(scene, keep, **rows),
            lambda camera: camera.fitted(shadows.bounding_points(scene), near=near, far=far),
            step,
        )
        if frame is not None:
            pictures.write(wanted, frame, step, depth_set=depth_set, camera=scene.camera)
    for line in drawing.report(frame) if frame is not None and report else []:
        typer.echo(line)
    emptiness.say(shown, lambda: shadows.culled(scene))
    _end(kept.case, scene, params, inputs)


def _drawing(scene: Any, params: Any, maps: Any, in_bands: bool) -> shadows_drawing.Drawing:
    """How what the options describe is drawn."""
    from ibr_ref import shadows

    if isinstance(scene, shadows.Ensemble):
        return shadows_several.drawing(scene, params, maps)
    if isinstance(params, shadows.SoftParams):
        return shadows_drawing.soft(scene, params, in_bands)
    return shadows_drawing.one(scene, params, maps)


def _end(case: Path | None, scene: Any, params: Any, inputs: dict[str, Any]) -> None:
    """Write the case, and say what of the caster a light does not see."""
    from ibr_ref import shadows

    if isinstance(scene, shadows.Ensemble):
        shadows_several.say_cut(scene, params)
    elif not isinstance(params, shadows.SoftParams):
        own_case.write(case, scene, params, **inputs)
        if params.method != "pcss":  # whose map is not the light's own
            emptiness.say_cut(shadows.cut_by_light(scene, params))


def goes_with() -> dict[str, Beside]:
    """Beside which others each option is read."""
    from ibr_ref.shadows.inputs import READ_BY
    from ibr_ref.shadows.soft import READ_BY as READ_BY_SOFT

    def warped(name: str) -> Beside:
        return Beside(f"others do not read {name}", {"method": READ_BY[name]})

    return {
        **pictures.goes_with("eye", "target"),
        **always("out", "bits", "caster", "offset", "light", "light_target", "light_power", "method"),
        **always("near", "far", "size", "report", "stages", "depth_set"),
        "case": Beside(own_case.WHY, {"method": named("shadows").judged[1]}),
        "up": Beside("the built-in horse stands", {"caster": GIVEN}),
        "samples": Beside("others take the whole light", {"method": MAPPED}),
        "light_size": Beside(
            "light_size is that of more than its centre", {"method": (*SOFT, "pcss")}, {"samples": (5, 9)}
        ),
        "map_size": Beside("rays need no map_size", {"method": (*SHADOWED_BY, *READ_BY_SOFT["map_size"])}),
        "map_samples": Beside(
            "map_samples count coverage", {"method": MAPPED, "content": "mask"}, {"method": READ_BY_SOFT["map_samples"]}
        ),
        "content": Beside("others do not read content", {"method": MAPPED}),
        "rows": warped("rows"),
        "columns": warped("columns"),
        "policy": warped("policy"),
        "interpolation": warped("interpolation"),
        "controls": Beside("no others have control points", {"method": "warp"}),
        "maps": Beside("no others are made beforehand", {"method": "warp"}),
    }
