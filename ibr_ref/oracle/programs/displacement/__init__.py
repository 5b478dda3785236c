"""Protruded displacement mapping: its program."""

from ibr_ref.oracle.programs.displacement.port import Port

__all__ = ["Port"]
