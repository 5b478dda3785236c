"""Images, meshes, depth images, stage dumps: everything that touches a file."""

from ibr_ref.io.camera_paths import read_camera_path
from ibr_ref.io.depth_sets import read_depth_cameras, read_depth_set, write_depth_set
from ibr_ref.io.films import check_film_writable, write_film
from ibr_ref.io.frame import Frame
from ibr_ref.io.heights import HeightMap, read_height, read_height_map
from ibr_ref.io.images import check_image_writable, read_image, write_image
from ibr_ref.io.meshes import read_mesh
from ibr_ref.io.msr import has_msr_picture, read_msr, read_msr_cameras
from ibr_ref.io.outputs import check_writable
from ibr_ref.io.point_cloud import write_point_cloud
from ibr_ref.io.posters import poster_bands, write_poster
from ibr_ref.io.simple_texture import read_simple_texture, write_simple_texture
from ibr_ref.io.textures import read_color, read_normal, read_normal_height
from ibr_ref.io.upright import read_upright
from ibr_ref.io.values import read_values

__all__ = [
    "Frame",
    "HeightMap",
    "check_film_writable",
    "check_image_writable",
    "check_writable",
    "has_msr_picture",
    "poster_bands",
    "read_camera_path",
    "read_color",
    "read_depth_cameras",
    "read_depth_set",
    "read_height",
    "read_height_map",
    "read_image",
    "read_mesh",
    "read_msr",
    "read_msr_cameras",
    "read_normal",
    "read_normal_height",
    "read_simple_texture",
    "read_upright",
    "read_values",
    "write_depth_set",
    "write_film",
    "write_image",
    "write_point_cloud",
    "write_poster",
    "write_simple_texture",
]
