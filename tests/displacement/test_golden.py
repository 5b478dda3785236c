"""The golden frames have not changed by a bit."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest

from ibr_ref import displacement
from ibr_ref.displacement import render
from tests.agreement import check_agreement
from tests.displacement import golden
from tests.naive import displacement as twin


@pytest.mark.parametrize("name", golden.SCENES)
def test_frame_is_golden(name: str) -> None:
    changed = golden.changed(golden.digests(name), golden.golden()[name])
    assert not changed, f"{name}: {changed} changed; if that was meant: python -m tests.displacement.golden --write"


@pytest.mark.parametrize("name", [name for name in golden.SCENES if name != "exact"])
def test_scene_agrees_with_the_naive_twin(name: str) -> None:
    """On a smaller picture; the twin has no exact search."""
    check_agreement(displacement, twin, *golden.SCENES[name](64, 48))


def test_file_holds_these_scenes_only() -> None:
    assert list(golden.golden()) == list(golden.SCENES)


def test_every_scene_shows_something() -> None:
    for name, scene in golden.SCENES.items():
        shown = render(*scene(48, 36), stages=False).depth < 1.0
        assert shown.mean() > 0.2, name


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
