"""The pages that say what the methods are: they ship, everything that names them finds them, and cases get their part."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import ibr_ref
from ibr_ref import methods, pages
from ibr_ref.oracle import cases
from ibr_ref.oracle.files.features import features
from ibr_ref.oracle.schema import describe_inputs

ROOT = Path(__file__).resolve().parent.parent
METHODS = methods.names()
FILES = {
    "conventions.md": "conventions",
    "toy_method/method.md": "ramp",
    **{f"{name}/method.md": name for name in METHODS},
}


def titles(name: str) -> set[str]:
    return {section.title for section in pages.sections(name)}


# --- What names them -------------------------------------------------------------------------------------------------

CITED = re.compile(r"((?:[a-z]+/)?[A-Za-z]+\.md)((?:(?:, | and )\"[^\"]+\")*)")
BY_PATTERN = {Path(__file__).name, "methods.py"}
"""Files that name the pages of all methods at once."""
OTHERS = {"README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SOURCES.md"}


def test_every_page_that_is_cited_is_there() -> None:
    """In docstrings and comments: `displacement/method.md, "Stage march"` is a file of the package, and a heading of it."""
    found = 0
    for path in sorted([*ROOT.glob("ibr_ref/**/*.py"), *ROOT.glob("tests/**/*.py")]):
        for file, headings in CITED.findall(path.read_text(encoding="utf-8")):
            if file in OTHERS:
                continue
            near = path.parent.name  # "method.md beside this file"
            name = FILES.get(file) or FILES.get(f"{near}/{file}")
            assert name or path.name in BY_PATTERN, f"{path}: {file}"
            for heading in re.findall(r'"([^"]+)"', headings):
                found += 1
                assert name, path
                assert heading in titles(name), f"{path}: {file}, {heading!r}"
    assert found > 20


@pytest.mark.parametrize("name", METHODS)
def test_help_leads_to_the_page(name: str) -> None:
    text = " ".join((getattr(ibr_ref, name).__doc__ or "").split())
    assert f"`ibr-ref method {name}`" in text
    assert "or at h = 0" not in text


def test_help_of_the_package_leads_to_all() -> None:
    assert "`ibr-ref method conventions`" in (ibr_ref.__doc__ or "")


# --- Sections --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", pages.names())
def test_a_page_is_all_of_its_sections_without_marks(name: str) -> None:
    text = pages.page(name)
    assert text.startswith("# ")
    assert "<!--" not in text
    for section in pages.sections(name):
        assert f"{'#' * section.level} {section.title}\n" in text
        assert section.text in text
        assert section.text or section.level == 2
        assert "<!--" not in section.text, "a mark that is not the first line of its section"
    assert len(titles(name)) == len(pages.sections(name)), "a heading twice"


@pytest.fixture(scope="module")
def used() -> dict[str, frozenset[str]]:
    """The features of all cases, by name."""
    return {name: features(describe_inputs(cases.build(name))[0]) for name in cases.names()}


def test_every_mark_is_a_feature_of_a_case(used: dict[str, frozenset[str]]) -> None:
    """Else its section would be in no README; and every feature chooses something."""
    all_features = frozenset.union(*used.values())
    for name in pages.names():
        for section in pages.sections(name):
            assert section.only <= all_features | {"library"}, section.title
    marks = {word for name in pages.names() for section in pages.sections(name) for word in section.only}
    assert not all_features - marks, "features that choose nothing"


@pytest.mark.parametrize(
    ("case", "there", "absent"),
    [
        ("displacement-box", ["Facades", "The paper's interval", "Light", "Normals from the heights", "Without self-shadow"],
         ["The volume's interval", "Self-shadow", "Normals from the normal map", "Points", "Depth of the face", "Truth"]),
        ("displacement-mapped", ["Normals from the normal map"], ["Facades", "Gradients", "Normals from the heights"]),
        ("displacement-tiles", ["Facades", "Gradients", "The base alone", "Depth of the face", "Self-shadow"],
         ["The auxiliary faces", "Depth of the hit", "Without self-shadow"]),
        ("displacement-street", ["The volume's interval"], ["The paper's interval"]),
        ("displacement-extended", ["The extended base"], ["The auxiliary faces", "The base alone"]),
        ("splatting-discs", ["Points", "Discs", "Stage normals", "Widths"], ["Squares", "Ellipses", "Footprints"]),
        ("splatting-ellipses", ["Footprints", "Ellipses", "Averages", "Lighting"], ["Squares", "Widths", "The nearest"]),
        ("shadows-box", ["Six warps", "Silhouettes", "In floats"], ["Three warps", "Depths", "Four comparisons", "Light"]),
        ("shadows-nearest", ["Three warps", "In 8 bits"], ["Six warps", "In floats"]),
        ("shadows-direct", ["Maps rendered directly"], ["Stage warp", "Six warps", "Stage controls"]),
    ],
)  # fmt: skip
def test_a_case_gets_what_it_uses(
    used: dict[str, frozenset[str]], case: str, there: list[str], absent: list[str]
) -> None:
    method = case.split("-")[0]
    text = pages.excerpt("conventions", used[case], 1) + pages.excerpt(method, used[case], 1)
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    assert not [title for title in there if title not in headings]
    assert not [title for title in absent if title in headings]


@pytest.mark.parametrize("case", ["displacement-metropolis", "splatting-kettle", "shadows-stage"])
def test_an_excerpt_keeps_the_order_and_moves_headings_down(used: dict[str, frozenset[str]], case: str) -> None:
    method = case.split("-")[0]
    whole = [section.title for section in pages.sections(method)]
    found = re.findall(r"^(#+) (.+)$", pages.excerpt(method, used[case], 1), re.MULTILINE)
    assert [title for title in whole if title in {t for _, t in found}] == [title for _, title in found]
    levels = {section.title: section.level for section in pages.sections(method)}
    assert all(len(marks) == levels[title] + 1 for marks, title in found)
