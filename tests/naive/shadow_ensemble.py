"""shadows/method.md, "Several casters, several lights": pixel by pixel, from the stages of each caster under each light."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from .patch import Camera
from .shadow_light import light_samples_of
from .shadow_maps import placed_vertices
from .shadow_project import Projected
from .shadow_surface import Fragment, Surface, draw_mesh
from .shadows import Stages, accumulate, image_stages, per_sample, plain_offset, project_samples
from .vectors import Vec3, Vec4, dot, negate, normalize, sub, towards, vec3, vec4


def alone(ensemble: Any, caster: int, light: int) -> Any:
    """A caster and a light as a scene of one each."""
    moved = ensemble.casters[caster]
    return SimpleNamespace(
        receivers=ensemble.receivers,
        caster=moved.mesh,
        offset_axes=moved.offset_axes,
        offset_range=moved.offset_range,
        offset=moved.offset,
        light=ensemble.lights[light],
        camera=ensemble.camera,
    )


def visible_surface(ensemble: Any) -> Surface:
    """The receivers in order, then the casters in order, each at its offset."""
    camera = Camera(ensemble.camera)
    surface: Surface = [[None] * camera.width for _ in range(camera.height)]
    for mesh in ensemble.receivers:
        draw_mesh(surface, mesh, [vec3(v) for v in mesh.vertices], camera, caster=False)
    for i, moved in enumerate(ensemble.casters):
        scene = alone(ensemble, i, 0)
        draw_mesh(surface, moved.mesh, placed_vertices(scene, plain_offset(scene)), camera, caster=True)
    return surface


def union(shadows: list[np.ndarray]) -> np.ndarray:
    """At every pixel the largest of the casters' shadows."""
    result = np.zeros(shadows[0].shape)
    for row in range(len(result)):
        for column in range(len(result[row])):
            result[row, column] = max(float(shadow[row, column]) for shadow in shadows)
    return result


def resolved_color(fragment: Fragment, shadows: list[float], ensemble: Any, eye: Vec4) -> Vec3:
    """surface (ambient + the sum of power (1 - ambient) (1 - shadow) max(0, n.l)), at most 1."""
    normal = fragment.normal
    if dot(normal, towards(eye, fragment.world)) < 0.0:
        normal = negate(normal)
    ambient, powers = float(ensemble.ambient), [float(power) for power in ensemble.powers]
    brightness = ambient
    for light, power, shadow in zip(ensemble.lights, powers, shadows, strict=True):
        to_light = normalize(sub(vec3(light.position), fragment.world))
        brightness = brightness + power * (((1.0 - ambient) * (1.0 - shadow)) * max(0.0, dot(normal, to_light)))
    r, g, b = (component * brightness for component in fragment.color)
    if sum(powers) > 1.0:
        return min(r, 1.0), min(g, 1.0), min(b, 1.0)
    return r, g, b


def resolve(ensemble: Any, surface: Surface, shadows: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """(color (H, W, 3), depth (H, W)), from one sum (H, W) a light."""
    color = np.empty((len(surface), len(surface[0]), 3))
    depth = np.ones(color.shape[:2])
    eye = vec4(ensemble.camera.eye)
    for row, line in enumerate(surface):
        for column, fragment in enumerate(line):
            if fragment is None:
                color[row, column] = vec3(ensemble.background)
                continue
            color[row, column] = resolved_color(fragment, [float(s[row, column]) for s in shadows], ensemble, eye)
            depth[row, column] = fragment.depth
    return color, depth


def render(ensemble: Any, params: Any, controls: Any = None) -> tuple[Stages, np.ndarray, np.ndarray]:
    """(stages, color, depth); controls: [caster][light], for the method that has any."""
    surface, stages, sums = visible_surface(ensemble), {}, []
    for light in range(len(ensemble.lights)):
        casters: list[list[Projected]] = []
        for caster in range(len(ensemble.casters)):
            scene = alone(ensemble, caster, light)
            samples = light_samples_of(scene, params)
            points = None if controls is None else controls[caster][light]
            made, images = image_stages(scene, params, samples, points, None)
            projections = project_samples(scene, params, surface, samples, images)
            for name in Projected._fields:
                made[f"project.{name}"] = per_sample([getattr(projection, name) for projection in projections])
            stages.update({f"light{light}.caster{caster}.{name}": array for name, array in made.items()})
            casters.append(projections)
        unions = [union([projected.shadow for projected in sample]) for sample in zip(*casters, strict=True)]
        sums.append(accumulate(unions, str(params.accumulation)))
        stages.update({f"light{light}.union.shadow": per_sample(unions), f"light{light}.accumulate.shadow": sums[-1]})
    color, depth = resolve(ensemble, surface, sums)
    return stages, color, depth
