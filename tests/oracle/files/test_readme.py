"""A case's README: all that a port of it is written from."""

from __future__ import annotations

import pytest

from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files.features import features
from ibr_ref.oracle.files.text import readme
from ibr_ref.oracle.schema import describe
from ibr_ref.pages import sections
from tests.oracle.files.cases import CASES

pytestmark = pytest.mark.usefixtures("one_thread")


def test_it_names_every_field_and_every_array(case: Case) -> None:
    document, inputs = describe(case)
    text = readme(document)
    for model in (document.params, document.scene):
        assert not [name for name in type(model).model_fields if f"`{name}`" not in text]
    assert not [file for file in inputs.arrays if file not in text]
    for stage in document.expected:
        assert (f"| {stage.name} |" if stage.kind == "result" else f"`{stage.name}`") in text


def test_it_has_the_sections_that_the_case_uses_and_no_others(case: Case) -> None:
    document, _ = describe(case)
    text = readme(document)
    used = features(document)
    for page in ("conventions", document.method):
        for section in sections(page):
            shown = f"\n{'#' * (section.level + 1)} {section.title}\n" in text and section.text in text
            if section.only:
                assert shown == bool(section.only & used), section.title
            else:
                assert shown, section.title
    assert "<!--" not in text


def test_where_a_search_ends_is_said_as_the_code_has_it() -> None:
    """k = K, not h = 0: with the volume's interval they are not the same, and a port by the old words failed there."""
    text = readme(describe(CASES["maps"]())[0])
    assert "its hit is k = K" in text
    assert "or at h = 0" not in text


def test_it_says_what_a_discard_leaves() -> None:
    text = readme(describe(CASES["maps"]())[0])
    assert "| where nothing is | where discarded |" in text
    rows = {
        line.split(" | ")[0].removeprefix("| "): line.split(" | ")[-3:-1] for line in text.splitlines() if "| " in line
    }
    assert rows["march.height_before"] == ["NaN", "0"]
    assert rows["raster.patch"] == ["NaN", "own"]
    assert rows["color"] == ["the background", "-"]
    assert "where discarded" not in readme(describe(CASES["direct"]())[0])
