"""Which of the systems that are judged a bug may be in."""

MAPPED = ("warp", "direct", "grid")
"""A map of shadows for each sample of the light."""
ALL = (*MAPPED, "pcss")
"""And one map that is softened."""
