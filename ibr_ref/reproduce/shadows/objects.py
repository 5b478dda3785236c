"""The objects of the paper: Newell's teapot and the cow where their files are, otherwise what the package makes."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import ibr_ref
from ibr_ref import io, models
from ibr_ref.scene import Mesh

DATA = Path(ibr_ref.__file__).resolve().parents[2] / "shared" / "data" / "models"


@cache
def objects() -> dict[str, Mesh]:
    """Teapot, chair and cow with z up, by the names of what they are here."""
    teapot, cow = DATA / "teapot.bpt", DATA / "cow.obj"
    return {
        **({"teapot": io.read_upright(teapot)} if teapot.is_file() else {"kettle": models.kettle()}),
        "chair": models.chair(),
        **({"cow": io.read_upright(cow)} if cow.is_file() else {"horse": models.horse()}),
    }


def which() -> str:
    """What stands for the paper's objects, in a sentence."""
    made = [
        f"our {ours} for the {theirs}" for ours, theirs in (("kettle", "teapot"), ("horse", "cow")) if ours in objects()
    ]
    counts = ", ".join(f"{name} {len(mesh.triangles):,}" for name, mesh in objects().items())  # type: ignore[arg-type]
    return f"Triangles: {counts}" + (f"; {' and '.join(made)}, whose files are not here." if made else ".")
