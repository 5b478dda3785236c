"""The conventions of all cases, in words: what a port needs to know to agree number by number."""

from __future__ import annotations

from ibr_ref import pages

CONVENTIONS = pages.bullets("conventions", "In short")
"""By name, as the page has them."""
