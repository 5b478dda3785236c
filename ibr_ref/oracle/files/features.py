"""Which parts of its method a case uses: by these the sections of its README are chosen (`ibr_ref.pages`)."""

from __future__ import annotations

from ibr_ref.oracle.schema import Document
from ibr_ref.oracle.schema.document import schema_of


def features(document: Document) -> frozenset[str]:
    """The words that the pages' marks may have, of one case."""
    return frozenset({document.method} | schema_of(document.method).features(document))
