"""The registry of searches: what is said of one in its line is what the method, the kernels and the command line do."""

from __future__ import annotations

from dataclasses import fields

import pytest
import typer

from ibr_ref.cli import app
from ibr_ref.displacement import Params, fragment, inputs
from ibr_ref.displacement.render import _settings
from ibr_ref.searches import SEARCHES, read_by
from tests.displacement.scenes import noise, square

SUNK = {"relief", "mcguire", "donnelly", "tatarchuk", "cone", "relaxed_cone", "maximum_mipmap"}


def test_those_without_a_file_are_the_kernel_s_own() -> None:
    assert tuple(name for name, search in SEARCHES.items() if search.room is None) == fragment.BUILT_IN
    assert [getattr(fragment, name.upper()) for name in fragment.BUILT_IN] == [*range(len(fragment.BUILT_IN))]
    assert (*fragment.BUILT_IN, *inputs.COMPARED) == inputs.METHODS


@pytest.mark.parametrize("name", inputs.COMPARED)
def test_every_other_has_a_search_in_its_file(name: str) -> None:
    room = SEARCHES[name].room
    assert room is not None
    assert callable(room.open().search)


@pytest.mark.parametrize("name", SEARCHES)
def test_the_kernels_are_told_what_the_line_says(name: str) -> None:
    settings = _settings(Params(method=name), square(noise(4, 4)))
    assert settings.floor == (-1.0 if name in SUNK else 0.0)
    assert settings.polygon_depth == (name == "welsh")
    assert settings.method == (fragment.BUILT_IN.index(name) if name in fragment.BUILT_IN else -1)
    assert _settings(Params(method=name, depth="polygon"), square(noise(4, 4))).polygon_depth


def test_fields_that_are_read_are_there() -> None:
    assert set(read_by()) - {"facade_map"} <= {field.name for field in fields(Params)}


def test_the_command_line_offers_all() -> None:
    render = typer.main.get_command(app).commands["render"]  # type: ignore[attr-defined]
    (option,) = [param for param in render.commands["displacement"].params if param.name == "method"]
    assert [*type(option.default)] == [*SEARCHES]
