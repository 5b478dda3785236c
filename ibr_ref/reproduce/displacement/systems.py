"""The systems of the paper's tables, three later ones, and with which parameters they are tried."""

from __future__ import annotations

from dataclasses import dataclass

from ibr_ref.displacement import Params


@dataclass(frozen=True)
class System:
    """A row of the tables."""

    name: str
    params: Params
    tracer: str
    """The paper's words in table 1 (and 2)."""
    marks: tuple[str, str, str] | None = None
    """Table 2: protrusion, steep displacement, silhouette; o available or good, ^ in between, x not."""


SYSTEMS = (
    System("texture mapping", Params(method="texture"), ""),
    System("Welsh 2004", Params(method="welsh"), "approximation + offset limit", ("x", "x", "x")),
    System("McGuire 2005", Params(method="mcguire", linear_steps=25), "linear + MIP-map LOD bias", ("^", "o", "x")),
    System("Donnelly 2005", Params(method="donnelly", linear_steps=16), "voxel ray-tracer", ("^", "^", "x")),
    System("Tatarchuk 2005", Params(method="tatarchuk"), "linear + dynamic sampling rate", ("^", "^", "x")),
    System(
        "Policarpo 2005", Params(method="relief", linear_steps=50), "linear search + binary search", ("^", "x", "x")
    ),
    System("cone steps, Dummer 2006", Params(method="cone", linear_steps=30), ""),
    System(
        "relaxed cones, Policarpo & Oliveira 2007",
        Params(method="relaxed_cone", linear_steps=15, binary_steps=8),
        "",
    ),
    System("maximum mipmap, Tevs 2008, Drobot 2009", Params(method="maximum_mipmap"), ""),
    System(
        "protruded, N = 10", Params(method="protruded", linear_steps=10), "protruded displacement, binary search, walls",
        ("o", "o", "o"),
    ),
    System(
        "protruded, N = 50", Params(method="protruded", linear_steps=50), "protruded displacement, binary search, walls",
        ("o", "o", "o"),
    ),
)  # fmt: skip

SETTINGS = (
    "McGuire: N = 25 (25 to 50 steps), LOD bias 1; Donnelly: 16 steps, 32 layers; Tatarchuk: 8 to 50 steps; Policarpo: "
    "50 + 6; cones: 30; relaxed cones: 15 + 8; protruded: N + 6, threshold 0.1."
)
