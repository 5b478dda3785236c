"""Where a scene of shadows is: for the planes of cameras."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.scene.boxes import box_corners
from ibr_ref.shadows.ensemble import Ensemble
from ibr_ref.shadows.inputs import Scene


def bounding_points(scene: Scene | Ensemble) -> Floats:
    """(8, 3) points in world space whose convex hull holds all that is drawn: `camera.fitted` takes them."""
    bounds = [mesh.bounds for mesh in scene.receivers]
    bounds += [mesh.bounds + offset @ axes for mesh, axes, offset in scene.movers]
    return box_corners(np.concatenate(bounds))
