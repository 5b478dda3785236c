"""The fixed-function GPU that all methods share: clipping, triangles, texture fetches, depth test and blending.

It knows no method and no scene: every function goes from arrays to arrays. Conventions (rows, NDC, snapping, fill
rule) are those of the package's docstring.
"""
