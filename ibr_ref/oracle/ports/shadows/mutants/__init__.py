"""Ports of shadows with one bug each, by the stage that is wrong."""

from ibr_ref.oracle.ports.shadows.mutants import accumulate, controls, depth, maps, project, resolve, warp

MUTANTS = tuple(
    mutant for stage in (maps, controls, warp, depth, project, accumulate, resolve) for mutant in stage.fault.mutants
)
"""In the order of the stages; the picture's depth before what is projected onto it."""

__all__ = ["MUTANTS"]
