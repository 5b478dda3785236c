"""The fixed-function pipeline on numbers with bounds: coverage, varyings, the texture unit."""
