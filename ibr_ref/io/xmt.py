"""The `DepthImage` nodes of an XMT-A text: parsed, and their fields as numbers and paths.

The XML goes through the standard library's expat, and a document type is refused: without one there are no entities,
hence no bombs and no files but those that `url` names. (The package defusedxml does the same around the same parser.)
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple, NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from ibr_ref.io.inside import file_inside
from ibr_ref.scene import checks
from ibr_ref.scene.axis_angle import AxisAngle

_NAMESPACE = "urn:mpeg:mpeg4:xmta:schema:"
"""A year follows."""
_MAX_BYTES = 2**22
"""Of text: ten thousand nodes."""
_DEFAULTS = {
    "position": "0 0 10",
    "orientation": "0 0 1 0",
    "fieldOfView": "0.785398 0.785398",
    "nearPlane": "10",
    "farPlane": "100",
    "orthographic": "true",
}
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


class DepthImageNode(NamedTuple):
    """A `DepthImage` node."""

    fields: AxisAngle
    orthographic: bool
    near: float
    far: float
    color: Path
    depth: Path | None
    """None: the alpha of `color`."""


def depth_images(data: bytes) -> list[Element]:
    """All `DepthImage` elements of a file's bytes, at least one, in its order.

    Raises ValueError for what is no XMT-A or has none, and for one in a moved `Transform`.
    """
    elements = list(_depth_images(_parsed(data)))
    if not elements:
        raise ValueError("found no DepthImage node, allowed: one or more")
    return elements


def depth_image_node(element: Element, folder: Path) -> DepthImageNode:
    """The fields of a `DepthImage` element of a file in `folder`; the standard's defaults where they are missing.

    Raises ValueError for fields that are none, a node without a `SimpleTexture`, `USE`, and files outside the folder.
    """
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
    return DepthImageNode(
        AxisAngle((x, y, z), (axis_x, axis_y, axis_z, angle), (horizontal, vertical)),
        _BOOLEANS[word],
        near,
        far,
        _path(_child(texture, "texture", "ImageTexture"), folder),
        _path(_child(texture, "depth", "ImageTexture"), folder) if depth else None,
    )


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
    raise ValueError(
        f"found a document type ({checks.one_line(repr(name))}), allowed: XML without one, hence without entities"
    )


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
    if not quoted and name[:1] in ("'", '"'):
        raise checks.reject("url", url[:200], "the name of one file, in the folder of this one or below")
    return file_inside("url", folder, name)
