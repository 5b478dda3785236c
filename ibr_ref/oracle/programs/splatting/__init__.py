"""Splatting of depth images: its program."""

from ibr_ref.oracle.programs.splatting.port import Port

__all__ = ["Port"]
