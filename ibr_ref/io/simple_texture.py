"""Depth images as MPEG-4 AFX has them: an XMT-A text with `DepthImage` and `SimpleTexture` nodes, images beside it.

    <XMT-A xmlns="urn:mpeg:mpeg4:xmta:schema:2002"><Header/><Body><Replace><Scene><Group><children>
      <DepthImage position="0 0 10" orientation="0 0 1 0" fieldOfView="0.785398 0.785398"
                  nearPlane="10" farPlane="100" orthographic="true">
        <diTexture><SimpleTexture>
          <texture><ImageTexture url="&quot;color.png&quot;"/></texture>
          <depth><ImageTexture url="&quot;depth.png&quot;"/></depth>
        </SimpleTexture></diTexture>
      </DepthImage>
    </children></Group></Scene></Replace></Body></XMT-A>

The numbers are the standard's defaults; note that `orthographic` is true. The camera looks down -z of its own space, +y
up; `position` and `orientation` place it; `fieldOfView` is (horizontal, vertical), the full angles in radians, or the
width and height of the box; the planes are distances from the camera. The depth codes k end at K, 255 or 65535, and are
linear in the distance along the view axis:

    depth = nearPlane + (1 - (k - 1)/(K - 1)) (farPlane - nearPlane)    for k = 1 (far) to K (near); k = 0 is background.

**Checked**: names, types and defaults of the fields, in the node tables that GPAC generates its MPEG-4 scene graph from
and that follow ISO/IEC 14496-16; root, namespace, Header, Body and Replace in what GPAC writes, the quotes in `url` in what
it reads; `diTexture` as an element around its node, and the planes as distances from the viewpoint, in the proposers'
patents (abstract of US 7,606,428, claim 1 of US 8,022,951). **Not checked**, as the text of 14496-16 was not at hand, but
taken from memory of its node semantics: the formula, that bright is near and 0 background, that the alpha of `texture`
holds the codes where `depth` is missing, the camera's axes, and `fieldOfView` as the size of an orthographic box.
"""

from __future__ import annotations

import html
from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.afx_fields import fields_of
from ibr_ref.io.depth_codes import depth_codes
from ibr_ref.io.files import contents, naming
from ibr_ref.io.images import write_image
from ibr_ref.io.outputs import atomic, check_writable
from ibr_ref.io.textures import read_color
from ibr_ref.io.xmt import DepthImageNode, depth_image_node, depth_images
from ibr_ref.scene import Camera, DepthImage, checks

_LAST = 65535
"""The largest depth code that is written."""
_DOCUMENT = """<?xml version="1.0" encoding="UTF-8"?>
<XMT-A xmlns="urn:mpeg:mpeg4:xmta:schema:2002">
 <Header/>
 <Body>
  <Replace>
   <Scene>
    <Group>
     <children>
{nodes}     </children>
    </Group>
   </Scene>
  </Replace>
 </Body>
</XMT-A>
"""
_NODE = """      <DepthImage {fields}>
       <diTexture>
        <SimpleTexture>
         <texture><ImageTexture url="&quot;{color}&quot;"/></texture>
         <depth><ImageTexture url="&quot;{depth}&quot;"/></depth>
        </SimpleTexture>
       </diTexture>
      </DepthImage>
"""


def read_simple_texture(path: str | PathLike[str]) -> tuple[DepthImage, ...]:
    """Read all `DepthImage` nodes of an XMT-A file, in its order. The module's text says how.

    Colours are PNG or JPEG; depths PNG, grey or RGB with equal channels, in 8 or 16 bits; both lie in the file's folder
    or below it.

    Raises OSError or ValueError, in one line that starts with the path (an image's own, if it is to blame), for files
    that are missing, unreadable or cut off, a document type, fields that are none, a `DepthImage` without a
    `SimpleTexture` or in a moved `Transform`, `USE` and object descriptors, images outside the folder, be it by a link,
    sizes that differ, and what makes no `Camera` or `DepthImage`.
    """
    path = Path(path)
    data = contents(path)
    with naming(path):
        elements = depth_images(data)
    nodes = []
    for i, element in enumerate(elements, 1):
        with naming(f"{path}: DepthImage {i}"):
            nodes.append(depth_image_node(element, path.parent))
    return tuple(_image(node, f"{path}: DepthImage {i}") for i, node in enumerate(nodes, 1))


def _image(node: DepthImageNode, where: str) -> DepthImage:
    color = read_color(node.color, exif=False)
    codes, last = depth_codes(node.depth or node.color, alpha=node.depth is None)
    height, width = codes.shape
    if color.shape[:2] != codes.shape:
        found = f"{color.shape[1]} x {color.shape[0]} pixels"
        raise ValueError(
            f"{checks.named(node.color)}: found {found}, allowed: {width} x {height}, the size of {node.depth}"
        )
    with naming(where):
        camera = Camera.axis_angle(
            position=node.fields.position,
            orientation=node.fields.orientation,
            field_of_view=node.fields.field_of_view,
            orthographic=node.orthographic,
            near=node.near,
            far=node.far,
            width=width,
            height=height,
        )
        nearness = (codes - 1.0) / (last - 1.0)
        depth = camera.far * (1.0 - nearness) + camera.near * nearness  # exact at both ends
        return DepthImage(color=color, depth=depth, camera=camera, mask=codes > 0.0)


def write_simple_texture(path: str | PathLike[str], images: Sequence[DepthImage]) -> None:
    """Write an XMT-A file, and beside it, for each image, NAME-000-color.png and NAME-000-depth.png.

    Colours are kept in 8 bits, depths in 16: `read_simple_texture` gives them back to half a step of
    (far - near)/65534, with the same masks; and the same cameras, those of `Camera.axis_angle` to the last bit, all
    others to rounding. The images are written first, the file that names them last.

    Raises ValueError, with the path and the image, for a camera that the fields cannot express (a skew, a centre off the
    picture's, a measured rotation, which is none to 1e-12, near below 0) and for a depth outside the camera's planes, which
    is where the codes end; OSError where nothing can be written.
    """
    path = Path(path)
    if not path.stem.isprintable() or set(path.stem) & set('"\\:'):
        raise ValueError(
            f'{checks.named(path)}: found the name {path.stem!r}, allowed: printable characters other than " \\ :'
        )
    images = tuple(images) if isinstance(images, Sequence) else ()
    if not images or not all(isinstance(image, DepthImage) for image in images):
        raise ValueError(
            f"{checks.named(path)}: images: found something else or none, allowed: a sequence of DepthImages"
        )
    check_writable(path)
    names = [[f"{path.stem}-{i:03d}-{kind}.png" for kind in ("color", "depth")] for i in range(len(images))]
    nodes = ""
    for i, (image, (color, depth)) in enumerate(zip(images, names, strict=True)):
        with naming(f"{path}: images[{i}]"):
            _codes(image)  # before anything is written
            urls = {"color": html.escape(color), "depth": html.escape(depth)}
            nodes += _NODE.format(fields=_attributes(image.camera), **urls)
    for image, (color, depth) in zip(images, names, strict=True):
        write_image(path.parent / color, image.color)
        write_image(path.parent / depth, _codes(image) / _LAST, bits=16)
    with atomic(path) as file:
        file.write(_DOCUMENT.format(nodes=nodes).encode())


def _codes(image: DepthImage) -> NDArray[np.float64]:
    """(H, W) whole numbers, 1 to 65535, and 0 off the mask."""
    _, depth, mask = image.arrays
    near, far = image.camera.near, image.camera.far
    codes = 1.0 + np.rint((far - depth) / (far - near) * (_LAST - 1.0))
    bad = mask & ~((codes >= 1.0) & (codes <= _LAST))
    if bad.any():
        row, column = np.argwhere(bad)[0].tolist()
        allowed = f"camera.near to camera.far, {near!r} to {far!r}, which the codes span"
        raise checks.reject(f"depth[{row}, {column}]", float(depth[row, column]), allowed)
    return np.where(mask, codes, 0.0)


def _attributes(camera: Camera) -> str:
    if camera.near < 0.0:
        raise checks.reject("camera.near", camera.near, "in AFX fields: >= 0")
    fields = camera.afx or fields_of(camera)
    values = {
        "position": _text(fields.position),
        "orientation": _text(fields.orientation),
        "fieldOfView": _text(fields.field_of_view),
        "nearPlane": _text((camera.near,)),
        "farPlane": _text((camera.far,)),
        "orthographic": "false" if camera.perspective else "true",
    }
    return " ".join(f'{name}="{value}"' for name, value in values.items())


def _text(numbers: Sequence[float]) -> str:
    return " ".join(repr(float(number)) for number in numbers)
