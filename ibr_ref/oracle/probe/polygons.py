"""What a port of displacement mapping drew of one case says of its device's rasterizer, filter and depth buffer.

The case has many small polygons at random places, each with its own maps of bytes. From the port's own arrays follow

- `subpixel_bits`: the corners, snapped to each raster, cover other pixels: the raster under which most pixels have the face
  that they have; of equal ones the coarsest;
- `varyings`: whether the points on the faces are those of the snapped corners, or of the corners as they were;
- `texel_weight_bits`, `filter_result`: which filter gives the albedo at the port's own hit;
- `depth_format`: whether depths are multiples of a fixed-point step.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.displacement import Params, Scene
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.probe.measured import Measured
from ibr_ref.oracle.programs.displacement.port import Port
from ibr_ref.scene import BasePolygon, Camera, Light, checks

NEEDED = ("raster.face", "raster.patch_id", "raster.patch", "march.hit_index", "march.hit", "shade.albedo", "depth")
"""What has to be handed in."""
BITS = range(4, 11)
ROUNDINGS = ("even", "down")
BETTER = 4.0
"""How many times nearer the better of two explanations has to come."""
FITS = 4e-6
"""Of colours: a filter in float32."""
MOST = 0.98
"""Share of the hits whose albedo has to fit: weights and bytes at a tie go either way."""
GRID = (8, 6)
"""Columns and rows of polygons."""


def probe_case() -> Case:
    """Polygons in a plane before an orthographic camera, at places that are on no raster."""
    random = np.random.default_rng(11)
    polygons = []
    for row, column in np.ndindex(GRID[1], GRID[0]):
        corner = np.array([column + 0.1, row + 0.1]) + random.uniform(0.0, 0.15, 2)
        # Any edges that are no multiples of a subpixel.
        u, v = np.array([[0.6, 0.1], [-0.1, 0.6]]) + random.uniform(-0.04, 0.04, (2, 2))
        polygons.append(
            BasePolygon(
                corner=(*corner, 0.0),
                edge_u=(*u, 0.0),
                edge_v=(*v, 0.0),
                height_map=random.integers(60, 200, (6, 6)) / 255.0,
                color_map=random.integers(0, 256, (7, 5, 3)) / 255.0,
                height_scale=0.05,  # flat enough that no hit lies beside its polygon
            )
        )
    camera = Camera.orthographic(
        eye=(4.0, 2.5, 3.0),
        target=(4.0, 3.0, 0.0),
        up=(0, 1, 0),
        view_height=6.6,
        near=0.5,
        far=8.0,
        width=352,
        height=264,
    )
    scene = Scene(polygons=polygons, camera=camera, light=Light(direction=(0.2, -0.3, 1.0)))
    params = Params(linear_steps=6, binary_steps=2, faces="base", steep_threshold=0.4)
    return Case(
        name="probe-polygons",
        method="displacement",
        kind="typical",
        about="Many small polygons, from which the numbers of a device are measured: `ibr-ref probe`.",
        profile="ieee32",
        scene=scene,
        params=params,
    )


def measure(case: Case, arrays: Mapping[str, Any]) -> Measured:
    """The device of a drawing of the case. Raises ValueError for arrays that are missing or have another size."""
    for name in NEEDED:
        if name not in arrays:
            raise checks.reject("probe", f"no {name}", ", ".join(NEEDED))
        if np.shape(arrays[name])[:2] != (case.scene.camera.height, case.scene.camera.width):
            raise checks.reject(name, np.shape(arrays[name]), "the picture's size")
    numbers: dict[str, int | str] = {}
    why: dict[str, str] = {}
    for found in (_raster(case, arrays), _filter(case, arrays), _depth(np.asarray(arrays["depth"], np.float64))):
        for name, (value, reason) in found.items():
            numbers[name], why[name] = value, reason
    return Measured(numbers, why)


Found = dict[str, tuple[int | str, str]]


def _raster(case: Case, arrays: Mapping[str, Any]) -> Found:
    """Subpixels by coverage, then what varyings are interpolated over."""
    owner = np.where(np.asarray(arrays["raster.face"]) >= 0, np.asarray(arrays["raster.patch_id"]), -1)
    wrong = {}
    for bits, rounding in itertools.product(BITS, ROUNDINGS):
        drawn, _ = _drawn(case, Policy(subpixel_bits=bits, subpixel_rounding=rounding))
        wrong[bits, rounding] = int((drawn != owner).sum())
    bits, rounding = min(wrong, key=lambda each: (wrong[each], each[0]))
    found: Found = {}
    others = min(count for (other, _), count in wrong.items() if other < bits) if bits > BITS[0] else None
    # Coarser rasters than the device's would have to be worse, and no raster may leave more than a few pixels.
    if wrong[bits, rounding] <= 2 and (others is None or others > 2 * wrong[bits, rounding]):
        against = "" if others is None else f", {others} with fewer bits"
        found["subpixel_bits"] = bits, f"{wrong[bits, rounding]} pixels are covered otherwise{against}"
    off = {}
    for snapped in (True, False):
        policy = Policy(float_bits=64, subpixel_bits=bits, subpixel_rounding=rounding, snapped_varyings=snapped)
        drawn, points = _drawn(case, policy)
        same = (drawn == owner) & (owner >= 0)
        gap = np.abs(points - np.asarray(arrays["raster.patch"], np.float64))[same]
        off[snapped] = float(np.median(gap.max(axis=1))) if gap.size else np.inf  # corners at a tie go either way
    better = off[True] < off[False]
    if BETTER * min(off.values()) < max(off.values()):
        said = f"off by {min(off.values()):.1e}, the other way {max(off.values()):.1e}"
        found["varyings"] = "snapped" if better else "unsnapped", said
    return found


def _drawn(case: Case, policy: Policy) -> tuple[Any, Floats]:
    """(H, W) the polygon at each pixel, -1 none, and (H, W, 3) the point on it, of a device."""
    camera = case.scene.camera
    owner, points = np.full((camera.height, camera.width), -1), np.full((camera.height, camera.width, 3), np.nan)
    port = Port(case.scene, case.params, policy, {})
    for number, patch in enumerate(port.patches()):
        fragments = port.fragments(port.quads(patch), 0)
        owner[fragments.row, fragments.column] = number
        points[fragments.row, fragments.column] = np.stack(fragments.point, axis=-1)
    return owner, points


def _filter(case: Case, arrays: Mapping[str, Any]) -> Found:
    """Which filter the albedo is of, at the port's own hits."""
    rows, columns = np.nonzero(np.asarray(arrays["march.hit_index"]) >= 0)
    owner = np.asarray(arrays["raster.patch_id"])[rows, columns]
    hit = np.asarray(arrays["march.hit"], np.float64)[rows, columns]
    albedo = np.asarray(arrays["shade.albedo"], np.float64)[rows, columns]
    off: dict[tuple[int, bool], float] = {}
    for bits, rounding, in_bytes in ((0, "", False), (8, "nearest", False), (8, "down", False), (8, "nearest", True)):
        policy = Policy(weight_bits=bits or None, weight_rounding=rounding, filtered_bytes=in_bytes)
        port, mixed = Port(case.scene, case.params, policy, {}), np.full(albedo.shape, np.nan)
        for number, polygon in enumerate(case.scene.polygons):
            mine = owner == number
            fetched = port.fetch(np.asarray(polygon.color_map, np.float64), hit[mine, 0], hit[mine, 1], False)
            mixed[mine] = fetched if np.ndim(fetched) == 2 else np.stack(fetched, axis=-1)
        most = float(np.quantile(np.abs(mixed - albedo), MOST, method="higher")) if len(albedo) else np.inf
        off[bits, in_bytes] = min(off.get((bits, in_bytes), np.inf), most)
    bits, in_bytes = min(off, key=lambda each: off[each])
    if off[bits, in_bytes] > FITS:
        return {}
    said = f"albedo off by {off[bits, in_bytes]:.1e}"
    return {"texel_weight_bits": (bits, said), "filter_result": ("unorm8" if in_bytes else "float", said)}


def _depth(depth: Floats) -> Found:
    """Multiples of a step, or floats."""
    drawn = depth[depth < 1.0]
    for name, most in (("unorm16", 2.0**16 - 1.0), ("unorm24", 2.0**24 - 1.0)):
        steps = most * drawn
        # Of a step: float32 is that near to whole ones only where depths are stored in them.
        if len(drawn) and np.abs(steps - np.rint(steps)).max() < (1e-2 if name == "unorm16" else 0.02):
            return {"depth_format": (name, f"every depth is a multiple of 1/{int(most)}")}
    return {"depth_format": ("float32", "depths are no multiples of a step")} if len(drawn) else {}
