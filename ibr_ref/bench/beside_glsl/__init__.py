"""Frames of the package and of the GLSL ports in turn: `python -m ibr_ref.bench.beside_glsl.displacement` and its kin."""
