"""Protruded displacement mapping: the plain port, its legal variants and its mutants."""

from ibr_ref.oracle.ports.displacement.mutants import MUTANTS
from ibr_ref.oracle.ports.displacement.port import Port
from ibr_ref.oracle.ports.displacement.variants import VARIANTS

__all__ = ["MUTANTS", "VARIANTS", "Port"]
