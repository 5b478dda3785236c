"""The verdict on a submission."""

from __future__ import annotations

from ibr_ref.oracle.findings import Findings
from ibr_ref.oracle.words import words


class Verdict(Findings):
    """What the oracle says of one submission."""

    def words(self) -> str:
        """The verdict for people: some ten lines, and how each wrong stage's witness is computed, folded where long."""
        return words(self)
