"""The referee of splatting: a room for each stage, the picture, the trace and the parameters."""

from ibr_ref.oracle.referees.splatting.referee import SplattingReferee

__all__ = ["SplattingReferee"]
