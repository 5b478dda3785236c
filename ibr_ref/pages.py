"""The pages that say what the methods do: whole, for readers, or cut to the sections that a case needs.

A page is Markdown. A section whose first line is `<!-- only: a b -->` is there for cases with the feature a or b alone, and
its subsections with it; the feature "library" is no case's. Nothing is imported here that takes time: `ibr-ref method`
must answer at once.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from importlib import resources
from typing import NamedTuple

from ibr_ref import methods

CONVENTIONS = "conventions"
"""The page of what all methods share."""

_ONLY = re.compile(r"\A\s*<!-- only: ([a-z0-9_ ]+) -->\n*")


class Section(NamedTuple):
    """A heading and what stands under it, up to the next one."""

    level: int
    """1 for the page's title."""
    title: str
    text: str
    """Without the mark, and without blank lines around it."""
    only: frozenset[str]
    """Features of which a case needs one; empty: every case needs the section."""


def names() -> tuple[str, ...]:
    """The pages, as `ibr-ref method` calls them: one a method, and what all share."""
    return (*methods.names(), CONVENTIONS)


def sections(name: str) -> tuple[Section, ...]:
    """The sections of a page, in order. Raises ValueError for a name that is none."""
    return _read("ibr_ref:conventions.md" if name == CONVENTIONS else methods.named(name).page)


@cache
def _read(place: str) -> tuple[Section, ...]:
    package, _, file = place.partition(":")
    source = resources.files(package).joinpath(file).read_text(encoding="utf-8")
    parts = re.split(r"^(#+) (.+)\n", source, flags=re.MULTILINE)[1:]
    return tuple(_section(*parts[i : i + 3]) for i in range(0, len(parts), 3))


def _section(marks: str, title: str, body: str) -> Section:
    only = _ONLY.match(body)
    text = body[only.end() :] if only else body
    return Section(len(marks), title, text.strip(), frozenset(only[1].split() if only else ()))


def page(name: str) -> str:
    """All of a page, without the marks."""
    return _joined(sections(name), 0)


def excerpt(name: str, features: Iterable[str], deeper: int = 0) -> str:
    """What a case with these features needs of a page; deeper: by how many levels headings move down."""
    wanted, kept, left_out = set(features), [], 99
    for section in sections(name):
        if section.level > left_out:
            continue
        left_out = 99 if not section.only or section.only & wanted else section.level
        if left_out == 99:
            kept.append(section)
    return _joined(kept, deeper)


def _joined(parts: Iterable[Section], deeper: int) -> str:
    blocks = (f"{'#' * (part.level + deeper)} {part.title}\n\n{part.text}".strip() for part in parts)
    return "\n\n".join(blocks) + "\n"


def bullets(name: str, title: str) -> dict[str, str]:
    """The items `- **word**: text` of a section, each text on one line."""
    (text,) = [section.text for section in sections(name) if section.title == title]
    items = re.split(r"^- \*\*([a-z_]+)\*\*: ", text, flags=re.MULTILINE)[1:]
    return {items[i]: " ".join(items[i + 1].split()) for i in range(0, len(items), 2)}
