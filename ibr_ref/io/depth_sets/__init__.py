"""Depth sets: folders of pictures with depth, intrinsics and poses, in the forms that people have them in.

Each module has one format, and says where it is from and what it leaves open; README.md in ibr_ref/io has the table.
"""

from ibr_ref.io.depth_sets.formats import FORMATS, READ_BY
from ibr_ref.io.depth_sets.read import read_depth_cameras, read_depth_set
from ibr_ref.io.depth_sets.write import write_depth_set

__all__ = ["FORMATS", "READ_BY", "read_depth_cameras", "read_depth_set", "write_depth_set"]
