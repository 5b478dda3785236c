"""Height maps from a texel on, colours, normals: noise, terraces, plateaus, spikes."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from ibr_ref.array_types import Floats
from ibr_ref.testing.numbers import real, seeds

SIZES = st.one_of(
    st.sampled_from([(1, 1), (1, 2), (1, 7), (2, 1), (9, 1), (2, 2), (16, 8), (33, 17), (40, 40)]),
    st.tuples(st.integers(2, 12), st.integers(2, 12)),
)
"""Rows and columns; the larger ones have more than one level of maxima."""


@st.composite
def height_maps(draw: DrawFn, sizes: SearchStrategy[tuple[int, int]] = SIZES) -> Floats:
    """Heights from exactly 0 to exactly 1: noise, terraces, plateaus, spikes and pits of one texel, ramps."""
    size = draw(sizes)
    random = np.random.RandomState(draw(seeds()))
    kind = draw(st.sampled_from(["flat", "noise", "terraces", "spikes", "pits", "boxes", "ramp"]))
    if kind == "noise":
        return random.random_sample(size)
    if kind == "terraces":
        return random.choice(np.array([0.0, 0.25, 0.5, 0.75, 1.0]), size)
    if kind == "flat":
        return np.full(size, draw(st.one_of(st.sampled_from([0.5, 0.0, 1.0, 0.25]), real(0.0, 1.0))))
    if kind == "ramp":
        return np.add.outer(np.linspace(0.0, 0.5, size[0]), np.linspace(0.0, 0.5, size[1]))
    ground, top = (1.0, 0.0) if kind == "pits" else (0.0, draw(real(0.2, 1.0, 1.0, 0.5)))
    heights = np.full(size, ground)
    for _ in range(draw(st.integers(1, 4))):
        row, column = random.randint(size[0]), random.randint(size[1])
        extent = random.randint(1, 2 + max(size) // 2, 2) if kind == "boxes" else (1, 1)
        heights[row : row + extent[0], column : column + extent[1]] = top
    return heights


@st.composite
def aligned_height_maps(draw: DrawFn) -> Floats:
    """Quarters on maps of powers of two: their bilinear mixes are exact at the places that `ALIGNED` cameras see."""
    size = draw(st.sampled_from([(1, 1), (2, 2), (4, 4), (8, 8), (1, 4), (4, 2)]))
    if draw(st.booleans()):
        return np.full(size, draw(st.sampled_from([0.0, 0.25, 0.5, 1.0])))
    return np.random.RandomState(draw(seeds())).choice(np.array([0.0, 0.25, 0.5, 1.0]), size)


@st.composite
def colors(draw: DrawFn, most: int = 5) -> Floats:
    """A map of random colours."""
    size = draw(st.tuples(st.integers(1, most), st.integers(1, most)))
    return np.random.RandomState(draw(seeds())).random_sample((*size, 3))


@st.composite
def normal_maps(draw: DrawFn) -> Floats:
    """Normals as colours: noise, all zero (0.5 stands for 0), or opposite ones that cancel between the texels."""
    kind = draw(st.sampled_from(["noise", "noise", "zero", "opposite"]))
    if kind == "noise":
        return draw(colors())
    normals = np.full((4, 6, 3), 0.5)
    if kind == "opposite":
        normals[:, ::2, 0], normals[:, 1::2, 0] = 1.0, 0.0
    return normals
