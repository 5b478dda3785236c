"""`ibr-ref render shadows`."""

from __future__ import annotations

import os
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import (
    depth_set_options,
    emptiness,
    options,
    own_case,
    pictures,
    shadows_drawing,
    shadows_several,
    shadows_stage,
)
from ibr_ref.cli.command import given
from ibr_ref.cli.described import Described, beside
from ibr_ref.cli.what_goes_with_what import GIVEN, Beside, always
from ibr_ref.methods import named
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.shadows import Maps, Params, Scene

EXAMPLES = """
Examples:

    ibr-ref render shadows --out horse.png

    ibr-ref render shadows --caster cow.obj --samples 9 --offset 0.3,-0.2 --out cow.png

    ibr-ref render shadows --light 2,1,4 --light-size 0.3,0.1 --samples 9 --out horse.png

    ibr-ref render shadows --caster cow.obj --method pcss --light-size 0.3 --report --out cow.png

    ibr-ref render shadows --caster cow.obj --controls best --maps cow.npz --samples 9 --report --out cow.png
"""


class Method(StrEnum):
    """Where the shadow map comes from; or another way to a soft shadow than samples of the light."""

    warp = "warp"
    direct = "direct"
    grid = "grid"
    traced = "traced"
    convolution = "convolution"
    pcss = "pcss"

    @property
    def soft(self) -> bool:
        """Drawn by `render_soft`."""
        return self in (Method.traced, Method.convolution)


class Policy(StrEnum):
    """How the maps around the object's place are warped."""

    dissolve = "dissolve"
    nearest = "nearest"


class Interpolation(StrEnum):
    """Pace of the control points between two maps."""

    linear = "linear"
    projective = "projective"


class Content(StrEnum):
    """What a map holds."""

    mask = "mask"
    depth = "depth"


class Controls(StrEnum):
    """Placement of the control points."""

    fast = "fast"
    best = "best"
    bounds = "bounds"
    identity = "identity"


def read(
    context: typer.Context,
    caster: shadows_stage.Casters = None,
    up: shadows_stage.UpAxis = None,
    offset: shadows_stage.Offsets = None,
    samples: Annotated[
        int, typer.Option(parser=options.whole, help="Samples of the light: 1 (a hard shadow), 5 or 9.")
    ] = 1,
    light: shadows_stage.Lights = None,
    light_target: shadows_stage.LightTargets = None,
    light_size: shadows_stage.LightSizes = None,
    light_power: shadows_stage.LightPowers = None,
    method: Annotated[
        Method,
        typer.Option(
            help="Maps warped, rendered for every sample, or a grid of them; or the whole light: rays, Soler & Sillion's "
            "convolution, percentage-closer soft shadows."
        ),
    ] = Method.warp,
    map_size: Annotated[int, typer.Option(parser=options.whole, help="Texels a side of a shadow map.")] = 512,
    map_samples: Annotated[
        int, typer.Option(parser=options.whole, help="k: a texel is the coverage of k x k samples.")
    ] = 1,
    rows: Annotated[int, typer.Option(parser=options.whole, help="Control points downwards.")] = 15,
    columns: Annotated[int, typer.Option(parser=options.whole, help="Control points across.")] = 5,
    policy: Annotated[Policy, typer.Option(help="Six warps a map, or three.")] = Policy.dissolve,
    interpolation: Annotated[
        Interpolation, typer.Option(help="Pace between two maps: even, as in the paper, or that of perspective.")
    ] = Interpolation.linear,
    content: Annotated[Content, typer.Option(help="Silhouettes, or depths.")] = Content.mask,
    controls: Annotated[Controls, typer.Option(help="How the control points are placed.")] = Controls.fast,
    maps: Annotated[
        Path | None,
        typer.Option(
            help="--method warp: prepared maps are read from here, with all that they were made with, or else written here "
            "(.npz)."
        ),
    ] = None,
    eye: Annotated[
        options.Vector,
        typer.Option(parser=options.vector, metavar="X,Y,Z", help="The eye; z is up, the floor is at -0.5."),
    ] = options.Vector(1.4, -3, 2.1),
    target: Annotated[
        options.Vector, typer.Option(parser=options.vector, metavar="X,Y,Z", help="Point looked at.")
    ] = options.Vector(0.15, 0.35, -0.1),
    near: options.Near = None,
    far: options.Far = None,
    size: Annotated[
        options.Size, typer.Option(parser=options.size, metavar="WxH", help="Pixels of the picture.")
    ] = options.Size(640, 480),
    *,
    within: Callable[[str, int, int], None] | None = None,
    case: Path | None = None,
) -> Described:
    """What the options describe, and the maps; within: told how far these are. Several casters or lights are an Ensemble.

    case: a folder for the case of it, which the oracle has for one of each alone: said before maps are prepared.

    Raises ValueError and OSError for what makes no scene.
    """
    from ibr_ref import io, shadows

    if maps is not None and not _kept(maps):
        io.check_writable(maps)
    ensemble = shadows_stage.stage(
        caster,
        up,
        offset,
        shadows_stage.stage_lights(light, light_target, light_size, light_power),
        eye=eye,
        target=target,
        width=size.width,
        height=size.height,
        near=near,
        far=far,
    )
    several = len(ensemble.pairs) > 1 or bool(light_power)
    if several:
        alone = {
            f"--method {method.value}": method.soft or method is Method.pcss,
            f"--maps {maps}": maps,
            f"--case {case}": case,
        }
        shadows_several.check_goes_with(ensemble, alone)
    first = ensemble.scene(0, 0)
    scene = ensemble if several else first
    if method.soft:
        return Described(first, shadows.SoftParams(method=method.value, map_size=map_size, map_samples=map_samples), {})
    fields: dict[str, Any] = {
        "map_size": map_size,
        "map_samples": map_samples,
        "rows": rows,
        "columns": columns,
        "policy": policy.value,
        "interpolation": interpolation.value,
        "content": content.value,
        "light_samples": samples,
        "method": method.value,
    }
    loaded = _loaded(maps, fields, controls, given(context))
    params = shadows.Params(**fields)
    if method is not Method.warp:
        return Described(scene, params, {})
    if several:
        made = shadows.prepare_ensemble(ensemble, params, controls=controls.value, progress=within)
        return Described(scene, params, {"maps": made})
    return Described(scene, params, {"maps": loaded or _prepared(first, params, controls, maps, within)})


@beside(read)
def command(
    out: options.Out,
    report: Annotated[
        bool,
        typer.Option(
            "--report", help="Print how far the shadow is from the rendered or traced one, and the maps' memory."
        ),
    ] = False,
    path: pictures.CameraPath = None,
    frames: pictures.Frames = 120,
    video: pictures.Video = None,
    fps: pictures.Fps = 30.0,
    scheduler: pictures.Scheduler = None,
    depth_set: depth_set_options.OneDepthImage = None,
    bits: options.Bits = 8,
    stages: Annotated[Path | None, typer.Option(help="Also write every stage array, as .npz.")] = None,
    case: own_case.Folder = None,
    **described: Any,
) -> None:
    """Shadows by image warping (Kang & Ihm 2002) of meshes that move over a floor with steps, under one light or several."""
    whole = {"stages": stages, "report": report, "depth_set": depth_set}
    wanted = pictures.Wanted(
        out=out, bits=bits, path=path, frames=frames, video=video, fps=fps, scheduler=scheduler, fov=40.0, whole=whole
    )
    with progress(3) as step:
        step("reading the mesh, preparing maps")
        from ibr_ref import io, shadows

        wanted.check(*described["size"])
        own_case.check_writable(case)
        if stages is not None:
            io.check_writable(stages)
        scene, params, inputs, _ = read(**described, within=step.within, case=case)
        several, soft = isinstance(scene, shadows.Ensemble), isinstance(params, shadows.SoftParams)
        if several:
            drawing = shadows_several.drawing(scene, params, inputs.get("maps"))
        elif soft:
            drawing = shadows_drawing.soft(scene, params, wanted.in_bands)
        else:
            drawing = shadows_drawing.one(scene, params, inputs.get("maps"))
        keep, near, far = report or stages is not None, described["near"], described["far"]
        shown, frame = pictures.draw(
            wanted,
            scene,
            params,
            lambda scene, **rows: drawing.render(scene, keep, **rows),
            lambda camera: camera.fitted(shadows.bounding_points(scene), near=near, far=far),
            step,
        )
        if frame is not None:
            pictures.write(wanted, frame, step, stages=stages, depth_set=depth_set, camera=scene.camera)
    for line in drawing.report(frame) if frame is not None and report else []:
        typer.echo(line)
    emptiness.say(shown, lambda: shadows.culled(scene))
    if several:
        shadows_several.say_cut(scene, params)
    elif not soft:
        own_case.write(case, scene, params, **inputs)
        if params.method != "pcss":  # whose map is not the light's own
            emptiness.say_cut(shadows.cut_by_light(scene, params))


def _kept(path: Path) -> bool:
    """Whether maps may be read from there: not from a pipe or a device, which are written to."""
    from ibr_ref.io.outputs import is_stream

    return os.path.exists(path) and not is_stream(path)  # Path.exists raises for names that are too long


def _loaded(path: Path | None, fields: dict[str, Any], controls: Controls, named: set[str]) -> Maps | None:
    """Maps from the file if it is there. Fields that were not named become the file's; those that were must be."""
    from ibr_ref import shadows

    if path is None or not _kept(path):
        return None
    maps = shadows.Maps.load(path)
    wanted = {**fields, "controls": controls.value}
    for name, value in {**maps.made_with, "controls": maps.placement}.items():
        if name in named and wanted[name] != value:
            flag = "--" + name.replace("_", "-")
            raise typer.BadParameter(f"{flag}: found {wanted[name]}, allowed: {value} ({name} of {path})")
    fields.update(maps.made_with)
    return maps


def _prepared(
    scene: Scene, params: Params, controls: Controls, path: Path | None, within: Callable[[str, int, int], None] | None
) -> Maps:
    """Maps made here, and written where a file is named."""
    from ibr_ref import shadows

    made = shadows.prepare(scene, params, controls=controls.value, progress=within)
    if path is not None:
        made.save(path)
    return made


def goes_with() -> dict[str, Beside]:
    """Beside which others each option is read."""
    from ibr_ref.shadows.inputs import MAPPED, METHODS, READ_BY
    from ibr_ref.shadows.soft import READ_BY as SOFT
    from ibr_ref.shadows.soft import SOFT_METHODS

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
            "light_size is that of more than its centre", {"method": (*SOFT_METHODS, "pcss")}, {"samples": (5, 9)}
        ),
        "map_size": Beside("rays need no map_size", {"method": (*METHODS, *SOFT["map_size"])}),
        "map_samples": Beside(
            "map_samples count coverage", {"method": MAPPED, "content": "mask"}, {"method": SOFT["map_samples"]}
        ),
        "content": Beside("others do not read content", {"method": MAPPED}),
        "rows": warped("rows"),
        "columns": warped("columns"),
        "policy": warped("policy"),
        "interpolation": warped("interpolation"),
        "controls": Beside("no others have control points", {"method": "warp"}),
        "maps": Beside("no others are made beforehand", {"method": "warp"}),
    }
