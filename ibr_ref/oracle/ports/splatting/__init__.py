"""A port of splatting."""

from ibr_ref.oracle.ports.splatting.port import Port

__all__ = ["Port"]
