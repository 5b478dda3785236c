"""Verdicts on ports: whether the image is right, and if not, where it first goes wrong."""
