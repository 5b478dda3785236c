"""Adversarial scenes for shadows, drawn by Hypothesis.

Positions, edges and ranges are drawn from values that tie with something (the light straight above, on an end of the range,
offsets on the middle line and on the ends) or spread evenly. What the API rejects is not drawn.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from ibr_ref.array_types import Floats
from ibr_ref.scene import Camera, Mesh
from ibr_ref.shadows import AreaLight, Params, Scene
from ibr_ref.testing.numbers import often, real, seeds


@dataclass(frozen=True)
class Drawn:
    """What one frame is rendered from."""

    scene: Scene
    params: Params
    controls: Floats


SIZES = st.tuples(st.integers(10, 22), st.integers(8, 16))
"""Width and height of pictures."""

REACH = 0.8
"""How far samples of a light may be from its centre along the axes, at the most."""

AXES = (
    ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ((0.0, 2.0, 0.0), (0.5, 0.0, 0.0)),
    ((0.9, 0.1, 0.2), (-0.3, 1.2, 0.1)),
)
"""Unit vectors, scaled and exchanged ones, and oblique ones off the ground's plane."""


WALLS = {
    "beside": np.array([(1.2, -3.0, -2.0), (1.2, 3.0, -2.0), (1.4, 3.0, 6.0), (1.4, -3.0, 6.0)]),
    "back": np.array([(3.0, 1.2, -2.0), (-3.0, 1.2, -2.0), (-3.0, 1.4, 9.0), (3.0, 1.4, 9.0)]),
}
"""Corners of plates that stand on the floor."""


def colors(draw: DrawFn, vertices: int) -> Floats:
    """One for the mesh, or one a vertex."""
    random = np.random.RandomState(draw(seeds()))
    return random.random_sample(3 if draw(st.booleans()) else (vertices, 3))


@st.composite
def casters(draw: DrawFn) -> Mesh:
    """A box, a plate, or loose triangles, no larger than 0.7 around the origin."""
    kind = draw(st.sampled_from(["plate", "soup", "box"]))
    if kind == "box":
        corners = np.array([(x, y, z) for x in (-0.4, 0.3) for y in (-0.2, 0.5) for z in (-0.3, 0.25)])
        quads = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
        triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        return Mesh(vertices=corners, triangles=triangles, color=colors(draw, 8))
    if kind == "plate":
        corners = np.array([(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)])
        return Mesh(vertices=corners, triangles=[(0, 1, 2), (0, 2, 3)], color=colors(draw, 4))
    random = np.random.RandomState(draw(seeds()))
    count = draw(st.integers(1, 6))
    vertices = random.uniform(-0.7, 0.7, (3 * count, 3))
    return Mesh(vertices=vertices, triangles=np.arange(3 * count).reshape(-1, 3), color=colors(draw, 3 * count))


@st.composite
def receivers(draw: DrawFn) -> list[Mesh]:
    """A floor under the caster; perhaps a wall beside it, or one at the back that reaches above the light."""
    half, z = draw(real(2.0, 6.0, 4.0)), draw(real(-1.6, -0.8, -1.0))
    floor = np.array([(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)])
    meshes = [Mesh(vertices=floor, triangles=[(0, 1, 2), (0, 2, 3)], color=colors(draw, 4))]
    wall = draw(st.sampled_from(["", "beside", "back"]))
    if wall:
        meshes.append(Mesh(vertices=WALLS[wall], triangles=[(0, 2, 1), (0, 3, 2)], color=colors(draw, 4)))
    return meshes


@st.composite
def lights(draw: DrawFn, axes: Floats, range_: Floats) -> AreaLight:
    """Above the caster; above an end or the middle of its range, or beside it."""
    x, y = (draw(real(-1.5, 1.5, float(range_[k, 0]), float(range_[k].mean()), 0.0)) for k in range(2))
    position = x * axes[0] + y * axes[1] + np.array([0.0, 0.0, draw(real(2.5, 5.0, 3.0, 4.0))])
    target = np.array([draw(real(-0.5, 0.5, 0.0)), draw(real(-0.5, 0.5, 0.0)), -1.0])
    size = draw(real(0.05, 0.6, 0.25))
    edges = np.array([size * axes[0] + draw(real(-0.2, 0.2, 0.0)) * axes[1], 0.5 * size * axes[1]])
    return AreaLight(
        position=position,
        target=target,
        up=draw(st.sampled_from([(0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.3, -0.8, 0.2)])),
        vertical_fov=draw(real(30.0, 110.0, 90.0)),
        near=draw(st.sampled_from([0.05, 0.5, 3.0])),
        far=draw(st.sampled_from([20.0, 5.0])),
        half_edges=edges,
    )


@st.composite
def cameras(draw: DrawFn, sizes: SearchStrategy[tuple[int, int]] = SIZES) -> Camera:
    """From beside and above, as it looks at the floor, and now and then up, at what is behind the light too."""
    width, height = draw(sizes)
    view: dict[str, Any] = {
        "eye": (draw(real(-3.0, 3.0)), draw(real(-4.0, -1.0)), draw(real(0.2, 4.0, 1.0))),
        "target": (draw(real(-0.5, 0.5, 0.0)), 0.0, draw(st.sampled_from([-0.8, -0.8, -0.8, 1.5, 6.0]))),
        "near": draw(st.sampled_from([0.1, 1.5])),
        "far": 20.0,
        "width": width,
        "height": height,
    }
    if draw(often(True, False)):
        return Camera.look_at(**view, vertical_fov=draw(real(30.0, 80.0)))
    return Camera.orthographic(**view, view_height=draw(real(2.0, 5.0)))


@st.composite
def offsets(draw: DrawFn, range_: Floats, light: tuple[float, float]) -> tuple[float, float]:
    """Anywhere in the range; on its ends, or just under the light, where the maps' middle line is."""
    return tuple(  # type: ignore[return-value]
        draw(real(low, high, low, high, min(max(own, low), high)))
        for (low, high), own in zip(range_, light, strict=True)
    )


@st.composite
def parameters(draw: DrawFn, light: AreaLight, axes: Floats) -> Params:
    """All parameters; the light's samples as a number or as a list of places."""
    samples: Any = draw(st.sampled_from([1, 1, 5, 9, "list", "list"]))
    if samples == "list":
        steps = np.random.RandomState(draw(seeds())).uniform(-0.2, 0.2, (draw(st.integers(1, 4)), 2))
        samples = np.asarray(light.position) + steps @ axes
    return Params(
        map_size=draw(st.integers(8, 20)),
        rows=draw(st.integers(2, 5)),
        columns=draw(st.integers(2, 5)),
        content=draw(st.sampled_from(["mask", "depth"])),
        map_samples=draw(st.sampled_from([1, 1, 2, 3])),
        quantize=draw(st.sampled_from([None, 8])),
        pcf=draw(st.booleans()),
        bias=draw(st.sampled_from([1e-3, 0.0, 0.02])),
        policy=draw(st.sampled_from(["dissolve", "nearest"])),
        light_samples=samples,
        accumulation=draw(st.sampled_from(["float", "unorm8"])),
        method=draw(st.sampled_from(["warp", "warp", "warp", "direct", "grid"])),
        grid_size=draw(st.integers(2, 4)),
        grid_mix=draw(st.booleans()),
    )


def unfolded_controls(seed: int, rows: int, columns: int) -> Floats:
    """Nine grids whose points are moved by less than a quarter of a cell, the border along itself."""
    random = np.random.RandomState(seed)
    grid = np.stack(np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows)), axis=-1)
    force = 0.24 / np.array([columns - 1, rows - 1])
    moves = random.uniform(-1.0, 1.0, (3, 3, rows, columns, 2)) * force
    moves[:, :, [0, -1], :, 1] = 0.0
    moves[:, :, :, [0, -1], 0] = 0.0
    moves[:, :, :: max(1, rows - 1), :: max(1, columns - 1)] = 0.0
    return np.clip(grid + moves, 0.0, 1.0)


@st.composite
def drawn(draw: DrawFn, sizes: SearchStrategy[tuple[int, int]] = SIZES) -> Drawn:
    """A whole scene, the parameters that it is rendered with, and controls without a fold."""
    axes = np.array(draw(st.sampled_from(AXES)))
    range_ = np.array([(draw(real(-1.0, -0.1, -0.5)), draw(real(0.1, 1.0, 0.5))) for _ in range(2)])
    light = draw(lights(axes, range_))
    scene = Scene(
        receivers=draw(receivers()),
        caster=draw(casters()),
        light=light,
        camera=draw(cameras(sizes)),
        offset_axes=axes,
        offset_range=range_,
        offset=draw(offsets(range_, (0.0, 0.0))),
        ambient=draw(real(0.0, 1.0, 0.2)),
        background=(0.1, 0.2, 0.3),
    )
    params = draw(parameters(light, axes))
    controls = unfolded_controls(draw(seeds()), params.rows, params.columns)
    if draw(st.booleans()) and in_front(scene):
        params = replace(params, interpolation="projective")
    return Drawn(scene, params, controls)


def in_front(scene: Scene) -> bool:
    """Whether the caster's middle is in front of the light wherever its maps may be, with room for the light's samples."""
    backwards = scene.light.camera(1).view_from_world[2]
    ends = np.asarray(scene.offset_range) + np.array([-REACH, REACH])
    positions = np.array([(x, y) for x in ends[0] for y in ends[1]])
    middles = scene.caster.bounds.mean(axis=0) + positions @ scene.axes
    return bool((middles @ backwards[:3] + backwards[3] < -1e-3).all())
