"""The demo's pictures of protruded displacement mapping: figures 6 and 15 of Yoo & Han 2006."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ibr_ref.demo.picture import SIZE, Picture

if TYPE_CHECKING:
    from ibr_ref.displacement import Params, Scene

SIZES = "640 x 480"
NOTE = "paper: GeForce 6600GT with 50 linear steps; `ibr-ref bench` measures with more care"
PICTURES = 12


def pictures() -> list[Picture]:
    """Figure 6 on the box, figure 15 on the city."""
    return _figure_6() + _city()


def _picture(name: str, caption: str, scene: Scene, params: Params, hide: tuple[int, ...] = ()) -> Picture:
    """hide: faces of the volume that are left out (figure 6d shows one auxiliary face alone)."""
    from ibr_ref import displacement

    def draw() -> Any:
        import numpy as np

        color = displacement.render(scene, params, stages=False).color
        hidden = np.isin(_faces(scene, params), hide) if hide else np.zeros(color.shape[:2], bool)
        return np.where(hidden[..., None], np.asarray(scene.background), color)

    return Picture(
        name=name,
        caption=caption,
        draw=draw,
        frame=lambda: displacement.render(scene, params, stages=False),
        settings="" if params.method == "texture" else f"{params.linear_steps} + {params.binary_steps} steps",
        paper_ms="40" if params.method == "protruded" and params.linear_steps == 50 else "",
    )


def _faces(scene: Scene, params: Params) -> Any:
    """(H, W) the face of the volume that each pixel is on, -1 none: the faces of one polygon share no pixel.

    The stage raster.face says the same, but a frame with stages is another compilation of the largest kernel.
    """
    import numpy as np

    from ibr_ref.displacement.patch_space import uniforms
    from ibr_ref.displacement.vertex import vertex_stage
    from ibr_ref.pipeline.clip import clip_triangles
    from ibr_ref.pipeline.triangles import set_up
    from ibr_ref.pipeline.visibility import visible

    (polygon,), camera = scene.polygons, scene.camera
    faces = vertex_stage(uniforms(polygon, camera, scene.light), params.drawn_faces, params.interval)
    clipped = clip_triangles(faces.clip, faces.patch, faces.triangles, camera.width, camera.height)
    seen = visible(set_up(clipped, camera.width, camera.height), camera.width, camera.height).triangle
    return np.where(seen >= 0, faces.numbers[clipped.source[seen] // 2], -1)


def _figure_6() -> list[Picture]:
    """The paper's figure 6 (a) to (f), on the same box."""
    from ibr_ref import displacement, models
    from ibr_ref.scene import Camera, Light

    box = models.box()
    camera = Camera.look_at(eye=(0.65, -1.3, 0.85), target=(0.0, 0.02, 0.08), near=0.05, far=10.0, **SIZE)
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
        _picture("figure_6a", "6 (a) texture mapping", low, replace(params, method="texture")),
        _picture("figure_6b", "6 (b) protruded displacement mapping", low, base),
        _picture("figure_6c", "6 (c) twice the height: the ground stays", tall, base),
        _picture("figure_6d", "6 (d) one auxiliary face", tall, params, hide=(1, 2)),
        _picture("figure_6e", "6 (e) all auxiliary faces", tall, params),
        _picture("figure_6f", "6 (f) steep walls with a facade", walls, params),
    ]


def _city() -> list[Picture]:
    """The paper's figure 15, on our own city: what each part of the method adds."""
    from ibr_ref import displacement, models
    from ibr_ref.scene import Camera, Light

    city = models.city()
    scene = displacement.Scene(
        polygons=[city],
        camera=Camera.look_at(eye=(2.1, -3.5, 1.9), target=(0.05, -0.1, 0.05), near=0.1, far=20.0, **SIZE),
        light=Light(direction=(-0.7, -0.5, 1.0)),
        background=(0.72, 0.82, 0.93),
    )
    plain = replace(scene, polygons=[replace(city, facade_map=None)])
    params = displacement.Params(linear_steps=100)
    return [
        _picture("figure_15a", "15 (a) texture mapping", scene, replace(params, method="texture")),
        _picture("figure_15b", "15 (b) relief mapping: the ground sinks", scene, replace(params, method="relief")),
        _picture("figure_15c", "15 (c) protruded: cut at the outline", plain, replace(params, faces="base")),
        _picture("figure_15d", "15 (d) auxiliary faces: the silhouette", plain, params),
        _picture("figure_15e", "15 (e) facades on steep walls", scene, params),
        _picture("city_shadows", "the same with self-shadow", scene, replace(params, shadow_steps=64)),
    ]
