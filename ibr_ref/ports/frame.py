"""What every sample port hands in."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Frame:
    """`color` (H, W, 3), `depth` (H, W), and the stages by the specification's names."""

    color: np.ndarray
    depth: np.ndarray
    stages: dict[str, np.ndarray] = field(default_factory=dict)
