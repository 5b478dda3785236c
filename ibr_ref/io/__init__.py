"""Images, stage dumps: everything that touches a file."""

from ibr_ref.io.frame import Frame
from ibr_ref.io.images import write_image

__all__ = ["Frame", "write_image"]
