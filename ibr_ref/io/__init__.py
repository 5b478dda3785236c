"""Images, meshes, stage dumps: everything that touches a file."""

from ibr_ref.io.frame import Frame
from ibr_ref.io.images import read_image, write_image
from ibr_ref.io.meshes import read_mesh
from ibr_ref.io.textures import read_color, read_height, read_normal, read_normal_height

__all__ = [
    "Frame",
    "read_color",
    "read_height",
    "read_image",
    "read_mesh",
    "read_normal",
    "read_normal_height",
    "write_image",
]
