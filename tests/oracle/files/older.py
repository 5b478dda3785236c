"""A case's folder as another version would have written it."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import numpy as np

from ibr_ref.oracle.files.npy import digest


def older(folder: Path, array: str = "depth") -> None:
    """Exchange an expected array, with all hashes, and say that something else made it."""
    place = folder / "expected" / f"{array}.npy"
    changed = 2.0 * np.load(place)
    np.save(place, changed)
    document = json.loads((folder / "case.json").read_text("utf-8"))
    document["made_by"] = "another 0.0.1"
    text = json.dumps(document).encode()
    (folder / "case.json").write_bytes(text)
    manifest = json.loads((folder / "manifest.json").read_text("utf-8"))
    manifest["arrays"][f"expected/{array}.npy"] = digest(changed)
    manifest["documents"]["case.json"] = hashlib.sha256(text).hexdigest()
    (folder / "manifest.json").write_text(json.dumps(manifest), "utf-8")
