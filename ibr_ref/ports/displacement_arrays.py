"""What the attachments of the displacement ports hold, under the specification's names, and a quadtree as a texture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def stage_arrays(
    index: np.ndarray, patch: np.ndarray, hit: np.ndarray, albedo: np.ndarray, normal: np.ndarray
) -> dict[str, np.ndarray]:
    """With the specification's values of "nothing here". Each (H, W, 4).

    index: face, patch id, linear and hit index; patch: C; hit: (u, v, h) and the height before; albedo, and whether it is
    lit; normal, and whether it is steep.
    """
    covered, kept, nothing = index[..., 0] >= 0, index[..., 3] >= 0, np.float32(np.nan)
    return {
        "raster.face": index[..., 0].copy(),
        "raster.patch_id": index[..., 1].copy(),
        "raster.patch": np.where(covered[..., None], patch[..., :3], nothing),
        "march.linear_index": index[..., 2].copy(),
        "march.hit_index": index[..., 3].copy(),
        "march.hit": np.where(kept[..., None], hit[..., :3], nothing),
        "march.height_before": np.where(covered, hit[..., 3], nothing),
        "march.steep": kept & (normal[..., 3] > 0.5),
        "shade.albedo": np.where(kept[..., None], albedo[..., :3], nothing),
        "shade.normal": np.where(kept[..., None], normal[..., :3], nothing),
        "shade.lit": kept & (albedo[..., 3] > 0.5),
    }


def below_one_another(levels: Sequence[np.ndarray]) -> np.ndarray:
    """Levels (rows, columns) of a quadtree in one picture, as wide as the first."""
    width = levels[0].shape[1]
    return np.vstack([np.pad(level, [(0, 0), (0, width - level.shape[1])]) for level in levels])
