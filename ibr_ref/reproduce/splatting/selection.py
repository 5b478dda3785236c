"""Which reference images to keep: the paper's open problem, on the rig of 32."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ibr_ref import models, splatting
from ibr_ref.io import write_image
from ibr_ref.metrics import psnr
from ibr_ref.reproduce.findings import Cell, Claim, Figure, Found, Table, Within
from ibr_ref.reproduce.splatting.canvas import framed, grid
from ibr_ref.reproduce.splatting.systems import hand_set
from ibr_ref.scene import Camera, DepthImage
from ibr_ref.splatting import Scene, Selection
from ibr_ref.splatting.selection import point_areas, seen_points

COUNT, WANTED = 32, 0.99
GREEN, GREY = (0.05, 0.65, 0.3), (0.8, 0.8, 0.8)


def run(folder: Path, within: Within, size: int = 128) -> Found:
    """The greedy order, what it covers, and what new views of the kept images are like."""
    mesh = models.kettle()
    images = models.depth_rig(mesh, COUNT, size=size)
    within("choosing", 0, 3)
    chosen = splatting.choose_references(images, 1.0)
    count = needed(chosen, WANTED)
    within("all sets of three and five", 1, 3)
    three, five = best_of(images)
    within("views", 2, 3)
    sets = {
        f"{count} by the greedy choice": [images[i] for i in chosen.order[:count]],
        f"the first {count} of the rig": images[:count],
        "9 evenly around (a rig of 9)": models.depth_rig(mesh, 9, size=size),
        f"all {COUNT}": images,
    }
    rows = tuple((name, len(some), *view_quality(some, images)) for name, some in sets.items())
    write_image(folder / "chosen.png", _montage(images, chosen.order[:count]))
    return Found(
        tables=(_shares_table(chosen, size), _views_table(rows)),
        figures=(
            Figure(
                title="References to keep",
                file="chosen.png",
                caption=f"The rig of {COUNT}; framed in green the {count} that see {WANTED:.0%} of what all see.",
            ),
        ),
        claims=(
            Claim(
                claim="An algorithm can choose the fewest reference images that represent an object.",
                published="future work (section 5)",
                measured=f"{count} of {COUNT}, chosen greedily, see {WANTED:.0%} of the surface; the best three see "
                f"{three:.1%}, the first three by the greedy choice {chosen.shares[2]:.1%}; the best five {five:.2%} and "
                f"{chosen.shares[4]:.2%}",
                holds=count < COUNT // 2,
                why="Set cover is NP-hard; the greedy choice is at most a factor ln n off. It was compared with all sets of "
                "three and of five.",
            ),
        ),
    )


def needed(chosen: Selection, share: float) -> int:
    """How many images see that share."""
    return next(i for i, reached in enumerate(chosen.shares, 1) if reached >= share)


def best_of(images: Sequence[DepthImage], tolerance: float = 0.01) -> tuple[float, float]:
    """The largest shares that any three and any five of the images see: all sets of them are tried."""
    seen = seen_points(images, tolerance)
    # Points that the same images see are one: thousands in place of tens of thousands.
    patterns, which = np.unique(seen.T, axis=0, return_inverse=True)
    weights = np.bincount(which.reshape(-1), point_areas(images, seen).astype(np.float64))
    pairs, triples = (_missed(patterns, count) for count in (2, 3))
    triples *= (weights / weights.sum()).astype(np.float32)
    fives = min(float((triples[first : first + 512] @ pairs.T).min()) for first in range(0, len(triples), 512))
    return 1.0 - float(triples.sum(axis=1).min()), 1.0 - fives


def _missed(patterns: NDArray[np.bool_], count: int) -> NDArray[np.float32]:
    """(sets, patterns) 1 where none of the images of a set sees a pattern, for all sets of so many."""
    sets = np.array(list(combinations(range(patterns.shape[1]), count)))
    return np.stack([~patterns[:, some].any(axis=1) for some in sets]).astype(np.float32)


def view_quality(some: Sequence[DepthImage], rig: Sequence[DepthImage]) -> tuple[float, float]:
    """What six new views miss of the object, percent, and their decibels where it is; widths by hand."""
    low, high = splatting.bounds(rig)
    center, reach = (low + high) / 2.0, float(np.sqrt(((high - low) ** 2).sum()))
    missed, errors, shown = 0, 0.0, 0
    for direction in ((1, 0.2, 0.5), (-1, -0.3, 0.4), (0.2, 1, 0.6), (-0.1, -1, 0.5), (0.3, 0.2, 1), (0.3, -0.8, -0.6)):
        camera = Camera.look_at(
            eye=center + 1.4 * reach * np.array(direction), target=center, near=0.01, far=20, width=320, height=240
        )
        truth = models.depth_image(models.kettle(), camera)
        color, _, mask = truth.arrays
        scene = Scene(images=some, camera=camera, light=None)
        frame = splatting.render(scene, replace(hand_set(some, camera), min_width=1.0))
        missed += int((mask & (frame.stages["raster.splat"] < 0)).sum())
        shown += int(mask.sum())
        errors += float(10.0 ** (-psnr(frame.color, color, mask) / 10.0)) * int(mask.sum())
    return 100.0 * missed / shown, -10.0 * float(np.log10(errors / shown))


def _shares_table(chosen: Selection, size: int) -> Table:
    rows = tuple(
        (needed(chosen, share), f"{share:.1%}", chosen.shares[needed(chosen, share) - 1])
        for share in (0.5, 0.75, 0.9, 0.95, 0.99, 0.999, 1.0)
    )
    return Table(
        title=f"How many of the {COUNT} references of the kettle, {size} x {size} pixels, are needed",
        columns=("images", "wanted", "share of the surface"),
        rows=rows,
        how="`splatting.choose_references`: the surface is what all images know of it, by area; an image sees a point that "
        "lands on one of its pixels at that pixel's depth, up to 1 %.",
    )


def _views_table(rows: tuple[tuple[Cell, ...], ...]) -> Table:
    return Table(
        title="New views of what is kept",
        columns=("references", "images", "pixels missed, %", "dB where the object is"),
        rows=rows,
        how="Six views of 320 x 240 around the kettle and below it, the law set by hand, against pictures of the mesh from "
        "there.",
    )


def _montage(images: Sequence[DepthImage], kept: Sequence[int]) -> NDArray[np.float64]:
    pictures = []
    for i, image in enumerate(images):
        color, _, mask = image.arrays
        shown = np.where(mask[..., None], color, 1.0)
        pictures.append(framed(shown, GREEN, 4) if i in kept else framed(shown, GREY, 1))
    return grid(pictures, 8)
