"""What a caller describes: cameras, lights, meshes, base polygons, depth images.

Frozen dataclasses, validated at construction.
"""

from ibr_ref.scene.area_light import AreaLight
from ibr_ref.scene.base_polygon import BasePolygon
from ibr_ref.scene.camera import Camera
from ibr_ref.scene.depth_image import DepthImage
from ibr_ref.scene.depth_set import DepthSet
from ibr_ref.scene.light import Light
from ibr_ref.scene.mesh import Mesh

__all__ = ["AreaLight", "BasePolygon", "Camera", "DepthImage", "DepthSet", "Light", "Mesh"]
