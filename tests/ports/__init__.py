"""Ports of the methods to a real graphics API: OpenGL 4.5, as an independent witness and as a competitor on time."""
