"""Roberts' sequence in two dimensions: points that fill a square evenly, however many there are."""

from __future__ import annotations

R2 = (0.7548776662466927, 0.5698402909980532)
"""From a point to the next, modulo 1: 1/g and 1/g^2 with g = 1.3247..., the root of x^3 = x + 1."""
