"""The golden frames have not changed by a bit."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref import displacement, splatting
from tests import golden
from tests.agreement import check_agreement
from tests.naive import displacement as displacement_twin
from tests.naive import splatting as splatting_twin
from tests.shadows import golden_scenes as shadow_scenes
from tests.shadows import twin as shadow_twin

TWINS: dict[str, Any] = {
    "displacement": (displacement, displacement_twin),
    "splatting": (splatting, splatting_twin),
    "shadows": (shadow_scenes, shadow_twin),
}
"""Modules with `render`; the shadows' twin is given the controls that the golden scenes have."""

WITHOUT_TWIN = ("displacement/exact", "shadows/wavelets", "splatting/ellipses")
"""The twins have no exact search, no wavelets, and no ellipses: these are compared with a plain loop of their own."""


@pytest.mark.parametrize("name", golden.SCENES)
def test_frame_is_golden(name: str) -> None:
    changed = golden.changed(golden.digests(golden.rendered(name)), golden.golden()[name])
    assert not changed, f"{name}: {changed} changed; if that was meant: python -m tests.golden --write"


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", [name for name in golden.SCENES if name not in WITHOUT_TWIN])
def test_scene_agrees_with_the_naive_twin(name: str) -> None:
    """On a smaller picture."""
    check_agreement(*TWINS[name.split("/")[0]], *golden.SCENES[name](64, 48))


def test_file_holds_these_scenes_only() -> None:
    assert list(golden.golden()) == list(golden.SCENES)


def test_every_scene_shows_something() -> None:
    for name in golden.SCENES:
        shown = golden.rendered(name, 48, 36).depth < 1.0
        assert shown.mean() > 0.2, name


def test_writing_a_scene_keeps_the_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And the order of all, whichever was written last."""
    kept = golden.golden()
    monkeypatch.setattr(golden, "GOLDEN", tmp_path / "golden.json")
    golden.write(dict(reversed({**kept, "displacement/box": {"color": "0"}}.items())))
    again = golden.golden()
    assert list(again) == list(kept)
    assert {name: arrays for name, arrays in again.items() if arrays != kept[name]} == {
        "displacement/box": {"color": "0"}
    }
    assert list(json.loads(golden.GOLDEN.read_text())) == list(golden.METHODS)


def test_digest_sees_values_types_and_shapes() -> None:
    values = np.array([[0.0, 1.0], [np.nan, np.inf]])
    others = [values.T, values.reshape(4), values.astype(np.float32), np.nan_to_num(values), np.zeros((2, 2), bool)]
    assert len({golden.digest(array) for array in (values, *others)}) == 1 + len(others)


def test_digest_is_of_values_not_of_bytes() -> None:
    values = np.array([[0.0, 1.0], [np.nan, 3.0]])
    negated = np.array([[-0.0, 1.0], [-np.nan, 3.0]])
    for same in (negated, np.asfortranarray(values), values.astype(">f8"), values[::-1][::-1]):
        assert golden.digest(same) == golden.digest(values)


def test_digest_is_the_stated_one() -> None:
    """Written out once, so that other languages can check the file."""
    content = b"<f8 (2,) " + bytes(8) + bytes.fromhex("000000000000f87f")
    assert golden.digest(np.array([-0.0, -np.nan])) == hashlib.sha256(content).hexdigest()


def test_changed_names_arrays_on_either_side() -> None:
    assert golden.changed({"a": "1", "b": "2", "c": "3"}, {"a": "1", "b": "0", "d": "4"}) == ["b", "c", "d"]
