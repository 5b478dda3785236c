"""glTF 2.0, as text (.gltf) or binary (.glb): the triangles of a scene at rest, and their vertex colours.

The document is checked by pydantic, its numbers are read by NumPy. Not left to trimesh, which reads wide colours by their
low bytes and leaves out sparse accessors, required extensions and fans, nor to pygltflib, which decodes no accessor.
"""

from ibr_ref.io.gltf.scene import decode

__all__ = ["decode"]
