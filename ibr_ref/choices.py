"""Parameters that are words: what each may be, for the methods, for files and for the command line, which imports no NumPy.

The searches of displacement mapping are in `searches`, which says more of them.
"""

from __future__ import annotations

# Displacement mapping
INTERVALS = ("paper", "volume")
FACES = ("auxiliary", "base", "extended")
DEPTHS = ("displaced", "polygon")

# Splatting
SHAPES = ("square", "disc", "ellipse")
DRAWN_BY = ("shader", "software")

# Shadows
CONTENTS = ("mask", "depth")
POLICIES = ("dissolve", "nearest")
INTERPOLATIONS = ("linear", "projective")
CONTROLS = ("fast", "best", "bounds", "identity")
MAPPED = ("warp", "direct", "grid")
"""Methods that have a map for each sample of the light."""
SHADOWED_BY = (*MAPPED, "pcss")
SOFT = ("traced", "convolution")
"""Methods for the whole light, which are not judged as ports are."""

# Files
HEIGHT_KINDS = ("hgt", "raw", "terrarium")
BYTE_ORDERS = ("little", "big")
CAMERA_AXES = ("opencv", "opengl")
POSES = ("camera_to_world", "world_to_camera")
DEPTHS_ALONG = ("axis", "ray")
PIXEL_CENTERS = ("integer", "half")
UP = ("y", "z")
