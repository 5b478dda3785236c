"""displacement/method.md, "Stage march": the search along one view ray, for protruded, relief and texture."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .patch import Camera, Patch
from .vectors import Vec3, towards

Position = Callable[[int], Vec3]  # lattice index k -> (u, v, h)


@dataclass
class March:
    """The march stage of one fragment. `hit` is None where it is discarded."""

    linear_index: int = -1
    hit_index: int = -1
    hit: Vec3 | None = None
    height_before: float = 0.0
    steep: bool = False
    margin: float = math.inf
    domain_margin: float = math.inf
    steep_margin: float = math.nan


# --- Samples ---------------------------------------------------------------------------------------------------------


class Sampler:
    """Compares lattice points with the height map, and remembers how close it came to another outcome."""

    def __init__(self, patch: Patch, position: Position, domain_test: bool, relief: bool) -> None:
        self.patch = patch
        self.position = position
        self.domain_test = domain_test
        self.relief = relief
        self.margin = math.inf
        self.domain_margin = math.inf

    def look(self, k: int) -> tuple[bool, float]:
        """(is lattice point k inside the solid, its H); an empty sample is (False, 0)."""
        u, v, h = self.position(k)
        if self.domain_test and self.is_empty(u, v):
            return False, 0.0
        height = self.patch.height_map.value(u, v)
        if self.relief:
            return self.compare_depth(-h, 1.0 - height), height
        return self.compare_height(h, height), height

    def is_empty(self, u: float, v: float) -> bool:
        """Outside [0, 1]^2; notes the distance from the border on either side."""
        outside = u < 0.0 or u > 1.0 or v < 0.0 or v > 1.0
        if outside:
            distance = max(-u, u - 1.0, -v, v - 1.0)
        else:
            distance = min(u, 1.0 - u, v, 1.0 - v)
        self.domain_margin = min(self.domain_margin, distance)
        return outside

    def compare_height(self, h: float, height: float) -> bool:
        """The protruded methods: inside where h < H."""
        if h != 0.0 and h != 1.0:
            self.margin = min(self.margin, abs(h - height))
        return h < height

    def compare_depth(self, d: float, depth: float) -> bool:
        """Relief: inside where d >= D."""
        if d != 0.0 and d != 1.0:
            self.margin = min(self.margin, abs(d - depth))
        return d >= depth


# --- Search ----------------------------------------------------------------------------------------------------------


def search(sampler: Sampler, linear_steps: int, binary_steps: int) -> tuple[int, int, float] | None:
    """Linear search, then binary search: (i, k, a), or None where nothing stopped it."""
    before = 0.0
    for i in range(linear_steps + 1):
        inside, height = sampler.look(i * 2**binary_steps)
        if inside:
            return i, binary_search(sampler, i, binary_steps), before
        before = height
    return None


def binary_search(sampler: Sampler, i: int, binary_steps: int) -> int:
    """The first lattice point known to be inside; a stop at i = 0 stays there."""
    if i == 0:
        return 0
    lo: int = (i - 1) * 2**binary_steps
    hi: int = i * 2**binary_steps
    for _ in range(binary_steps):
        mid = (lo + hi) // 2
        inside, _height = sampler.look(mid)
        if inside:
            hi = mid
        else:
            lo = mid
    return hi


# --- Intervals -------------------------------------------------------------------------------------------------------


def along(b: float, a: float, t: float) -> float:
    """One component of p(t) = B + (A - B) t."""
    return b + (a - b) * t


def paper_positions(c: Vec3, v: Vec3, lattice: int) -> Position:
    """interval="paper": from the plane h = 1 (point B) to the plane h = 0 (point A)."""
    down = c[2] / v[2]
    upwards = (1.0 - c[2]) / v[2]
    a_u, a_v = c[0] - v[0] * down, c[1] - v[1] * down
    b_u, b_v = c[0] + v[0] * upwards, c[1] + v[1] * upwards

    def position(k: int) -> Vec3:
        t = k / lattice
        return along(b_u, a_u, t), along(b_v, a_v, t), 1.0 - t

    return position


def volume_positions(c: Vec3, patch: Patch, lattice: int) -> Position:
    """interval="volume": from the entry into the unit cube, or the eye inside it, to the fragment."""
    b = volume_entry(c, patch)

    def position(k: int) -> Vec3:
        t = k / lattice
        return along(b[0], c[0], t), along(b[1], c[1], t), along(b[2], c[2], t)

    return position


def volume_entry(c: Vec3, patch: Patch) -> Vec3:
    """B of interval="volume"."""
    e_u, e_v, e_h, w = patch.eye
    if w == 1.0 and 0.0 <= e_u <= 1.0 and 0.0 <= e_v <= 1.0 and 0.0 <= e_h <= 1.0:
        return e_u, e_v, e_h
    v = towards(patch.eye, c)
    best_axis, best_tau = -1, math.inf
    for axis in range(3):
        if v[axis] == 0.0:
            continue
        tau = ((1.0 if v[axis] > 0.0 else 0.0) - c[axis]) / v[axis]
        if best_axis < 0 or tau < best_tau:
            best_axis, best_tau = axis, tau
    if best_axis < 0:
        return c
    b = [c[0] + v[0] * best_tau, c[1] + v[1] * best_tau, c[2] + v[2] * best_tau]
    b[best_axis] = 1.0 if v[best_axis] > 0.0 else 0.0
    return b[0], b[1], b[2]


def relief_positions(c: Vec3, v: Vec3, lattice: int) -> Position:
    """Section "The systems that the paper compares with": q(d) = C - (v_uv / v_h) d, at h = -d."""
    slope_u, slope_v = v[0] / v[2], v[1] / v[2]

    def position(k: int) -> Vec3:
        d = k / lattice
        return c[0] - slope_u * d, c[1] - slope_v * d, -d

    return position


# --- Methods ---------------------------------------------------------------------------------------------------------


def march_fragment(c: Vec3, patch: Patch, camera: Camera, params: Any) -> March:
    """The march stage of the fragment C, with the near plane's test that all methods share."""
    if params.method == "protruded":
        march = march_protruded(c, patch, params)
    elif params.method == "relief":
        march = march_relief(c, patch, params)
    else:
        march = march_texture(c, params)
    if march.hit is not None and camera.clip_position(patch.to_world(march.hit))[2] < 0.0:
        return March(margin=march.margin, domain_margin=march.domain_margin)
    return march


def march_protruded(c: Vec3, patch: Patch, params: Any) -> March:
    """Sections 3 and 4 of the paper, with either interval."""
    lattice = params.linear_steps * 2**params.binary_steps
    if params.interval == "volume":
        position = volume_positions(c, patch, lattice)
        sampler = Sampler(patch, position, domain_test=False, relief=False)
    else:
        v = towards(patch.eye, c)
        if v[2] <= 0.0:
            return March()
        position = paper_positions(c, v, lattice)
        sampler = Sampler(patch, position, domain_test=not patch.repeat, relief=False)

    found = search(sampler, params.linear_steps, params.binary_steps)
    march = March(margin=sampler.margin, domain_margin=sampler.domain_margin)
    if found is not None and found[1] < lattice:
        march.linear_index, march.hit_index, march.height_before = found
        march.hit = position(march.hit_index)
        rise = march.hit[2] - march.height_before
        march.steep = rise > params.steep_threshold
        march.steep_margin = abs(rise - params.steep_threshold)
    elif c[2] == 0.0 and 0.0 <= c[0] <= 1.0 and 0.0 <= c[1] <= 1.0:
        u, v_, _h = position(lattice)
        march.hit_index = lattice
        march.hit = (u, v_, 0.0)
        march.steep_margin = abs((0.0 - 0.0) - params.steep_threshold)
    return march


def march_relief(c: Vec3, patch: Patch, params: Any) -> March:
    """Policarpo 2005: the same search with depths below the polygon; every stop is an ordinary hit."""
    v = towards(patch.eye, c)
    if v[2] <= 0.0:
        return March()
    lattice = params.linear_steps * 2**params.binary_steps
    position = relief_positions(c, v, lattice)
    sampler = Sampler(patch, position, domain_test=not patch.repeat, relief=True)
    found = search(sampler, params.linear_steps, params.binary_steps)
    march = March(margin=sampler.margin, domain_margin=sampler.domain_margin)
    if found is not None:
        march.linear_index, march.hit_index, march.height_before = found
        march.hit = position(march.hit_index)
        march.steep_margin = math.inf
    return march


def march_texture(c: Vec3, params: Any) -> March:
    """Texture mapping: the fragment itself."""
    lattice = params.linear_steps * 2**params.binary_steps
    return March(hit_index=lattice, hit=(c[0], c[1], 0.0), steep_margin=math.inf)
