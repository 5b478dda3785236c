"""What the ports do besides being right: they know nothing of the package, refuse what they cannot draw, can be timed."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ibr_ref.ports
from ibr_ref import oracle

PORTS = Path(ibr_ref.ports.__file__).parent
FILES = [path for path in sorted(PORTS.rglob("*.py")) if path.name not in ("described.py", "drawing.py", "__main__.py")]
"""The ports, without what runs them."""


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PORTS)))
def test_nothing_else_of_the_package_is_imported(path: Path) -> None:
    """A port in another language has the folder alone."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        modules = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        modules += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        own = [module for module in modules if module.partition(".")[0] == "ibr_ref"]
        assert all(f"{module}.".startswith("ibr_ref.ports.") for module in own), own


def drawing(case: oracle.Case, device: Any, **options: Any) -> Any:
    from ibr_ref.ports.described import described
    from ibr_ref.ports.drawing import drawn

    return drawn(described(case.method, case.scene, case.params, **case.inputs), "glsl", device, **options)


def test_the_timed_displacement_is_the_same(device: Any) -> None:
    """Without stages, into bytes: of the same decisions."""
    case = oracle.build("displacement-slope")
    staged, timed, packed = (drawing(case, device, **options) for options in ({}, {"stages": False}, {"packed": True}))
    assert timed.stages == {}
    for other in (timed, packed):
        different = (abs(staged.color - other.color) > 1.0 / 255.0).any(axis=-1)
        assert different.mean() < 0.002


@pytest.mark.parametrize("name", ["shadows-depths", "shadows-soft", "shadows-thin"])
def test_the_timed_shadows_are_nearly_the_same(name: str, device: Any) -> None:
    """The sampler's own filter, bytes between the passes: a mix of two rounded twice, 8 bits of colour and light."""
    staged, timed = (drawing(oracle.build(name), device, stages=stages) for stages in (True, False))
    np.testing.assert_array_equal(staged.depth, timed.depth)
    assert abs(staged.color - timed.color).max() < 0.03
    assert abs(staged.color - timed.color).mean() < 0.003


def test_what_is_not_ported_is_refused_with_its_feature(device: Any) -> None:
    from ibr_ref.ports.described import described
    from ibr_ref.ports.drawing import drawn

    case = oracle.build("displacement-box")
    exported = described(case.method, case.scene, case.params, **case.inputs)
    exported.params.method = "exact"
    with pytest.raises(ValueError, match="method = 'exact': the port allows"):
        drawn(exported, "glsl", device)


def test_from_the_command_line(device: Any, tmp_path: Path) -> None:
    """Two folders; one line and no folder for what is not ported, or is no case."""
    box = oracle.build("displacement-box")
    oracle.export(box, tmp_path / "box")
    oracle.export(box, tmp_path / "other")
    document = tmp_path / "other" / "case.json"
    document.write_text(document.read_text("utf-8").replace('"method": "protruded"', '"method": "exact"'), "utf-8")

    def run(case: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "ibr_ref.ports", str(tmp_path / case), str(tmp_path / "port" / case)]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    assert run("box").returncode == 0
    names = {path.name for path in (tmp_path / "port" / "box").iterdir()}
    assert {"color.npy", "depth.npy", "march.hit_index.npy", "vertex.clip.npy", "port.json"} <= names
    assert np.load(tmp_path / "port" / "box" / "march.hit_index.npy").dtype == np.int32
    refused = run("other")
    assert refused.returncode == 1
    assert refused.stderr.strip() == (
        "displacement-box is not ported: method = 'exact': the port allows protruded, relief, welsh, mcguire, "
        "tatarchuk, cone, relaxed_cone, donnelly, maximum_mipmap"
    )
    assert not (tmp_path / "port" / "other").exists()
    nowhere = run("nowhere")
    assert nowhere.returncode == 1
    assert "nowhere: is no case" in nowhere.stderr
    assert len(nowhere.stderr.splitlines()) == 1
