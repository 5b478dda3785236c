"""Words of the command line that are not made of the package's own lists are the same."""

from __future__ import annotations

from ibr_ref import choices
from ibr_ref.cli.depth_set_options import Format
from ibr_ref.cli.draw import Port
from ibr_ref.io.depth_sets.formats import FORMATS
from ibr_ref.ports.drawing import SAMPLES
from ibr_ref.shadows import automatic, controls


def test_formats_of_depth_sets() -> None:
    assert {*Format} == {"auto", *FORMATS}


def test_sample_ports() -> None:
    assert {*Port} == {*SAMPLES}


def test_placements_of_controls() -> None:
    assert (*automatic.RECIPES, *controls.PLACEMENTS) == choices.CONTROLS
