"""Images, meshes, stage dumps: everything that touches a file."""

from ibr_ref.io.files import check_writable
from ibr_ref.io.frame import Frame
from ibr_ref.io.images import check_image_writable, read_image, write_image
from ibr_ref.io.meshes import read_mesh
from ibr_ref.io.textures import read_color, read_height, read_normal, read_normal_height

__all__ = [
    "Frame",
    "check_image_writable",
    "check_writable",
    "read_color",
    "read_height",
    "read_image",
    "read_mesh",
    "read_normal",
    "read_normal_height",
    "write_image",
]
