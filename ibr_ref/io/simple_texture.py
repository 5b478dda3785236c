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

The XML goes through the standard library's expat, and a document type is refused: without one there are no entities,
hence no bombs and no files but those that `url` names. (The package defusedxml does the same around the same parser.)
"""

from __future__ import annotations

import html
import math
import re
from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import NamedTuple, NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.depth_codes import depth_codes
from ibr_ref.io.files import atomic, check_writable, contents, naming
from ibr_ref.io.images import write_image
from ibr_ref.io.textures import read_color
from ibr_ref.scene import Camera, DepthImage, checks
from ibr_ref.scene.camera import AxisAngle
from ibr_ref.scene.trigonometry import arctangent

_NAMESPACE = "urn:mpeg:mpeg4:xmta:schema:"
"""A year follows."""
_MAX_BYTES = 2**22
"""Of text: ten thousand nodes."""
_LAST = 65535
"""The largest depth code that is written."""
_TOLERANCE = 1e-12
"""By which a camera may miss what the fields express: more than rounding, far less than any measurement."""
_DEFAULTS = {
    "position": "0 0 10",
    "orientation": "0 0 1 0",
    "fieldOfView": "0.785398 0.785398",
    "nearPlane": "10",
    "farPlane": "100",
    "orthographic": "true",
}
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}

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


class _Node(NamedTuple):
    """A `DepthImage` node."""

    fields: AxisAngle
    orthographic: bool
    near: float
    far: float
    color: Path
    depth: Path | None
    """None: the alpha of `color`."""


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
        elements = list(_depth_images(_parsed(data)))
        if not elements:
            raise ValueError("found no DepthImage node, allowed: one or more")
    nodes = []
    for i, element in enumerate(elements, 1):
        with naming(f"{path}: DepthImage {i}"):
            nodes.append(_node(element, path.parent))
    return tuple(_image(node, f"{path}: DepthImage {i}") for i, node in enumerate(nodes, 1))


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
        raise ValueError(f'{path}: found the name {path.stem!r}, allowed: printable characters other than " \\ :')
    images = tuple(images) if isinstance(images, Sequence) else ()
    if not images or not all(isinstance(image, DepthImage) for image in images):
        raise ValueError(f"{path}: images: found something else or none, allowed: a sequence of DepthImages")
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


# Reading


def _parsed(data: bytes) -> Element:
    if len(data) > _MAX_BYTES:
        raise ValueError(f"found {len(data)} bytes, allowed for XML: up to {_MAX_BYTES}")
    builder = TreeBuilder()
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartDoctypeDeclHandler = _refuse_doctype
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise ValueError(f"found XML that is damaged or cut off ({error}), allowed: well-formed XML") from None
    return builder.close()


def _refuse_doctype(name: str, *_: object) -> NoReturn:
    raise ValueError(f"found a document type ({name!r}), allowed: XML without one, hence without entities")


def _name(element: Element) -> str:
    """The node or field that an element is; empty for elements of other vocabularies."""
    namespace, _, name = element.tag.rpartition(" ")
    return name if not namespace or namespace.startswith(_NAMESPACE) else ""


def _depth_images(root: Element) -> Iterator[Element]:
    """All `DepthImage` elements, in the order of the file."""
    if _name(root) != "XMT-A":
        raise ValueError(f"found the root element {root.tag[:80]!r}, allowed: XMT-A")
    waiting = [(root, False)]
    while waiting:
        element, moved = waiting.pop()
        if _name(element) == "DepthImage":
            if moved:
                raise ValueError("found a DepthImage in a Transform with fields, allowed: DepthImages in world space")
            yield element
            continue
        moved = moved or (_name(element) == "Transform" and not set(element.keys()) <= {"DEF"})
        waiting.extend((child, moved) for child in reversed(element))


def _node(element: Element, folder: Path) -> _Node:
    _check_own(element)
    given = {name: value for name, value in element.items() if " " not in name and name != "DEF"}
    unknown = sorted(set(given) - set(_DEFAULTS))
    if unknown:
        raise ValueError(f"found the field {unknown[0][:80]!r}, allowed: {', '.join(_DEFAULTS)}")
    texts = {**_DEFAULTS, **given}
    x, y, z = _numbers("position", texts, 3)
    axis_x, axis_y, axis_z, angle = _numbers("orientation", texts, 4)
    horizontal, vertical = _numbers("fieldOfView", texts, 2)
    (near,), (far,) = _numbers("nearPlane", texts, 1), _numbers("farPlane", texts, 1)
    word = texts["orthographic"].strip().lower()
    if word not in _BOOLEANS:
        raise checks.reject("orthographic", texts["orthographic"], "true or false")
    if not (far > near and (near > 0.0 or (near == 0.0 and _BOOLEANS[word]))):
        allowed = "0 < nearPlane < farPlane, or orthographic, 0 <= nearPlane < farPlane"
        raise checks.reject("nearPlane, farPlane", (near, far), allowed)
    texture = _child(element, "diTexture", "SimpleTexture")
    depth = [child for child in texture if _name(child) == "depth"]
    return _Node(
        AxisAngle((x, y, z), (axis_x, axis_y, axis_z, angle), (horizontal, vertical)),
        _BOOLEANS[word],
        near,
        far,
        _path(_child(texture, "texture", "ImageTexture"), folder),
        _path(_child(texture, "depth", "ImageTexture"), folder) if depth else None,
    )


def _numbers(field: str, texts: dict[str, str], count: int) -> list[float]:
    try:
        numbers = [float(word) for word in texts[field].replace(",", " ").split()]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        raise checks.reject(field, texts[field][:80], "a finite number" if count == 1 else f"{count} finite numbers")
    return numbers


def _child(parent: Element, field: str, kind: str) -> Element:
    """The node in a field of another: in XMT-A, fields that hold nodes are elements as well."""
    fields = [element for element in parent if _name(element) == field]
    nodes = [node for element in fields for node in element]
    if len(fields) != 1 or len(nodes) != 1 or _name(nodes[0]) != kind:
        found = ", ".join(_name(node) or "another" for node in nodes) or "nothing"
        raise ValueError(f"{field}: found {found}, allowed: one {kind}")
    _check_own(nodes[0])
    return nodes[0]


def _check_own(node: Element) -> None:
    if "USE" in node.keys():  # noqa: SIM118, an Element's own `in` asks for children
        raise ValueError(f"found {_name(node)} USE={node.get('USE', '')[:80]!r}, allowed: a node of its own")


def _path(texture: Element, folder: Path) -> Path:
    """The file that an `ImageTexture` names: in this folder or below, and nowhere else."""
    url = texture.get("url", "").strip()
    quoted = re.fullmatch(r""""([^"]*)"|'([^']*)'""", url)
    name = (quoted[1] or quoted[2] or "") if quoted else url
    steps = re.split(r"[/\\]", name)
    if not steps[0] or ".." in steps or ":" in name or (not quoted and name[0] in "\"'"):
        raise checks.reject("url", url[:200], "the name of one file, in the folder of this one or below")
    path = folder / name
    if not path.resolve().is_relative_to(folder.resolve()):
        raise checks.reject("url", url[:200], "a file in the folder of this one or below, not a link out of it")
    return path


def _image(node: _Node, where: str) -> DepthImage:
    color = read_color(node.color)
    codes, last = depth_codes(node.depth or node.color, alpha=node.depth is None)
    height, width = codes.shape
    if color.shape[:2] != codes.shape:
        found = f"{color.shape[1]} x {color.shape[0]} pixels"
        raise ValueError(f"{node.color}: found {found}, allowed: {width} x {height}, the size of {node.depth}")
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


# Writing


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
    fields = camera.afx or _fields(camera)
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


def _fields(camera: Camera) -> AxisAngle:
    """What `Camera.axis_angle` would have to be given."""
    (f_x, s, c_x), (_, f_y, c_y), _ = camera.intrinsics.tolist()
    half_width, half_height = camera.width / 2.0, camera.height / 2.0
    off = max(abs(s) / abs(f_x), abs(c_x - half_width) / half_width, abs(c_y - half_height) / half_height)
    if off > _TOLERANCE or f_x < 0.0 or f_y < 0.0:
        allowed = f"in AFX fields: no skew, no mirroring, the picture's centre [{half_width}, {half_height}]"
        raise checks.reject("camera.intrinsics", camera.intrinsics.tolist(), allowed)
    r = camera.view_from_world[:3, :3]
    defect = float(np.abs(r.T @ r - np.eye(3)).max())
    if defect > _TOLERANCE or np.linalg.det(r) < 0.0:
        allowed = f"in AFX fields: a rotation, R^T R - I within {_TOLERANCE:g} (here {defect:.3g}): no measured one"
        raise checks.reject("camera.view_from_world", r.tolist(), allowed)
    if camera.perspective:
        position, sizes = camera.eye[:3], [2.0 * arctangent(half_width, f_x), 2.0 * arctangent(half_height, f_y)]
    else:
        position, sizes = camera.world_from_view[:3, 3], [camera.width / f_x, camera.height / f_y]
    x, y, z = position.tolist()
    return AxisAngle((x, y, z), _orientation(r.T), (sizes[0], sizes[1]))


def _orientation(rotation: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Axis and angle from the quaternion, of the four ways to it the one that divides nothing small (Shepperd 1978)."""
    (a, b, c), (d, e, f), (g, h, i) = rotation.tolist()
    x, y, z, w = max(
        (h - f, c - g, d - b, 1.0 + a + e + i),
        (1.0 + a - e - i, d + b, c + g, h - f),
        (d + b, 1.0 - a + e - i, h + f, c - g),
        (c + g, h + f, 1.0 - a - e + i, d - b),
        key=lambda quaternion: max(quaternion),
    )
    length = math.sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return 0.0, 0.0, 1.0, 0.0
    return x / length, y / length, z / length, 2.0 * arctangent(length, w)
