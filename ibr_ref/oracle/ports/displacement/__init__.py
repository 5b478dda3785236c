"""Protruded displacement mapping: the plain port, its legal variants and its mutants."""

from ibr_ref.oracle.ports.displacement.port import Port

__all__ = ["Port"]
