"""Shadows by image warping: its program."""

from ibr_ref.oracle.programs.shadows.port import Port

__all__ = ["Port"]
