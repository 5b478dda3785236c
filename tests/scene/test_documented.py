"""`help` says what fields mean, and who reads those that not all read."""

from __future__ import annotations

import pydoc
from dataclasses import fields

import pytest

from ibr_ref import displacement, methods, shadows, splatting
from ibr_ref.scene.documented import documented

PARAMS = [displacement.Params, splatting.Params, shadows.Params]


@pytest.mark.parametrize("kind", PARAMS)
def test_help_has_every_field_with_its_meaning(kind: type) -> None:
    lines = dict(line.split(": ", 1) for line in (kind.__doc__ or "").splitlines() if ": " in line)
    for field in fields(kind):
        assert len(lines[field.name]) > 3, field.name
    assert str(lines[fields(kind)[-1].name])[:20] in pydoc.render_doc(kind)


@pytest.mark.parametrize("method", methods.records(), ids=lambda method: method.name)
def test_rules_of_combination_are_those_that_hold(method: methods.Method) -> None:
    package = method.package.open()
    read_by = __import__(f"ibr_ref.{method.name}.inputs", fromlist=["READ_BY"]).READ_BY
    choice = "shape" if method.name == "splatting" else "method"
    for field in fields(package.Params):
        readers = read_by.get(field.name)
        (line,) = (each for each in package.Params.__doc__.splitlines() if each.startswith(f"{field.name}: "))
        assert (" Read by " in line) == (readers is not None)
        if readers is not None:
            assert line.endswith(f" Read by {choice} {' | '.join(readers)} alone.")


def test_a_class_without_a_source() -> None:
    kind = type("Made", (), {"__doc__": "Made of nothing.", "__module__": "builtins"})
    assert (documented()(kind).__doc__ or "").strip() == "Made of nothing."
