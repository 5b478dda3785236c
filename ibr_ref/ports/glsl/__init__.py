"""OpenGL 4.5: the extra `ibr_ref[gl]`."""
