"""Polygons by formula, in the plane and in space."""

from __future__ import annotations

import math

Point = tuple[float, ...]

CONVEX = {
    "square": [(0, 0), (2, 0), (2, 2), (0, 2)],
    "halved": [(0, 0), (1, 0), (2, 0), (2, 2), (1, 2), (0, 2)],
    "hexagon": [(2, 0), (4, 1), (4, 3), (2, 4), (0, 3), (0, 1)],
}
CONCAVE = {
    "dart": [(0, 0), (2, -1), (0.5, 0), (2, 1)],
    "ell": [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)],
    "comb": [(0, 0), (9, 0), *[(x, 3 if x % 2 else 1) for x in range(9, -1, -1)]],
    "bridge": [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)],
    "spiral": [
        (0, 0),
        (6, 0),
        (6, 6),
        (1, 6),
        (1, 2),
        (4, 2),
        (4, 4),
        (3, 4),
        (3, 3),
        (2, 3),
        (2, 5),
        (5, 5),
        (5, 1),
        (0, 1),
    ],
}
CROSSING = {
    "bowtie": [(0, 0), (2, 2), (2, 0), (0, 2)],
    "uneven": [(0, 0), (3, 2), (3, 0), (0, 1)],
    "pentagram": [(math.cos(4 * math.pi * k / 5), math.sin(4 * math.pi * k / 5)) for k in range(5)],
}
STAR = [
    ((3 if k % 2 else 1) * math.cos(math.pi * k / 7), (3 if k % 2 else 1) * math.sin(math.pi * k / 7))
    for k in range(14)
]

PLANES = {
    "xy": lambda x, y: (x, y, 0.5),
    "yx": lambda x, y: (y, x, 0.5),
    "zx": lambda x, y: (y, -1.0, x),
    "slanted": lambda x, y: (x + y, 2 * y - x, 3 * x + 0.25),
    "tiny": lambda x, y: (x * 2.0**-90, 0.0, y * 2.0**-90),
    "far": lambda x, y: (x + 4096, y - 8192, x - y),
    "huge": lambda x, y: (x * 2.0**900, y * 2.0**900, 0.0),
}


def shapes() -> dict[str, list[Point]]:
    """Simple polygons in all planes, from every first corner in one of them."""
    flat = {**CONVEX, **CONCAVE, "star": STAR}
    found = {f"{name}-{where}": [place(x, y) for x, y in corners]
             for name, corners in flat.items() for where, place in PLANES.items()}  # fmt: skip
    for name, corners in CONCAVE.items():
        for first in range(len(corners)):
            turned = corners[first:] + corners[:first]
            found[f"{name}-from-{first}"] = [PLANES["slanted"](x, y) for x, y in turned]
    return found
