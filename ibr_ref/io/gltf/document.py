"""The parts of a glTF document that triangles come from; materials, animations, cameras and the like are not looked at."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

_LONGEST = 160

_HARMLESS = ("KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_mesh_quantization")
"""Required extensions (their names begin so) that change no triangle, or that are read: quantization allows other types."""

_ALLOWED = {
    "string_pattern_mismatch": "a version that readers of glTF 2.0 read",  # patterns are those of versions alone
    "too_short": "more elements",
    "too_long": "fewer elements",
}
"""In place of pydantic's words."""

Index = Annotated[int, Field(ge=0)]
Count = Annotated[int, Field(ge=1)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Extensions = dict[str, Any]
Part = TypeVar("Part")


class _Part(BaseModel):
    model_config = ConfigDict(strict=True, extra="ignore", frozen=True)

    extensions: Extensions = {}


class Asset(_Part):
    """Which glTF it is."""

    version: Annotated[str, Field(pattern=r"^2\.\d+$")]
    minVersion: Annotated[str, Field(pattern=r"^2\.0$")] = "2.0"  # noqa: N815


class Buffer(_Part):
    """Bytes, in the file or beside it."""

    byteLength: Count  # noqa: N815
    uri: str | None = None


class BufferView(_Part):
    """A part of a buffer."""

    buffer: Index
    byteOffset: Index = 0  # noqa: N815
    byteLength: Count  # noqa: N815
    byteStride: Annotated[int, Field(ge=4, le=252, multiple_of=4)] | None = None  # noqa: N815


class SparseIndices(_Part):
    """Which elements are replaced."""

    bufferView: Index  # noqa: N815
    byteOffset: Index = 0  # noqa: N815
    componentType: Literal[5121, 5123, 5125]  # noqa: N815


class SparseValues(_Part):
    """What they are replaced by."""

    bufferView: Index  # noqa: N815
    byteOffset: Index = 0  # noqa: N815


class Sparse(_Part):
    """Elements that replace others."""

    count: Count
    indices: SparseIndices
    values: SparseValues


class Accessor(_Part):
    """Numbers in a part of a buffer."""

    bufferView: Index | None = None  # noqa: N815
    byteOffset: Index = 0  # noqa: N815
    componentType: Literal[5120, 5121, 5122, 5123, 5125, 5126]  # noqa: N815
    normalized: bool = False
    count: Count
    type: Literal["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"]
    sparse: Sparse | None = None


class Primitive(_Part):
    """Vertices and how they are joined."""

    attributes: dict[str, Index]
    indices: Index | None = None
    mode: Annotated[int, Field(ge=0, le=6)] = 4


class MeshPart(_Part):
    """What a node shows."""

    primitives: Annotated[list[Primitive], Field(min_length=1)]
    weights: list[Finite] = []


class Node(_Part):
    """A place in the scene."""

    mesh: Index | None = None
    children: list[Index] = []
    skin: Index | None = None
    weights: list[Finite] = []
    matrix: Annotated[list[Finite], Field(min_length=16, max_length=16)] | None = None
    translation: Annotated[list[Finite], Field(min_length=3, max_length=3)] | None = None
    rotation: Annotated[list[Finite], Field(min_length=4, max_length=4)] | None = None
    scale: Annotated[list[Finite], Field(min_length=3, max_length=3)] | None = None


class Scene(_Part):
    """Root nodes."""

    nodes: list[Index] = []


class Document(_Part):
    """A whole file."""

    asset: Asset
    extensionsRequired: list[str] = []  # noqa: N815
    buffers: list[Buffer] = []
    bufferViews: list[BufferView] = []  # noqa: N815
    accessors: list[Accessor] = []
    meshes: list[MeshPart] = []
    nodes: list[Node] = []
    scenes: list[Scene] = []
    scene: Index | None = None


def decode_document(text: bytes) -> Document:
    """Check a document. Raises ValueError for the first field that is wrong, and for an extension that would be needed."""
    try:
        document = Document.model_validate_json(text.removeprefix(b"\xef\xbb\xbf"))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise ValueError(_problem(first["type"], first["loc"], first["input"], first["msg"])) from None
    for name in document.extensionsRequired:
        if not name.startswith(_HARMLESS):
            raise refused("extensionsRequired", name, "KHR_mesh_quantization, and what changes no triangle")
    return document


def _problem(kind: str, place: tuple[int | str, ...], found: object, message: str) -> str:
    if kind == "json_invalid":
        return f"found what is no JSON ({message.removeprefix('Invalid JSON: ')}), allowed: a glTF document"
    where = ".".join(str(part) for part in place) or "the document"
    if kind == "missing":
        return f"{where}: found nothing, allowed: this field, which glTF requires"
    allowed = _ALLOWED.get(kind) or shortened(message.removeprefix("Input should be "))
    return f"{where}: found {shortened(repr(found))}, allowed: {allowed}"


def refused(field: str, found: object, allowed: str) -> ValueError:
    """The error for a field of the document."""
    return ValueError(f"{field}: found {shortened(str(found))}, allowed: {allowed}")


def shortened(text: str) -> str:
    """On one line of bounded length."""
    text = " ".join(text[:1000].split())
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def member(parts: list[Part], index: int, name: str) -> Part:
    """One that another part names. Raises ValueError for one that is not there."""
    if index >= len(parts):
        raise refused(
            name, f"a reference to {name}.{index}", f"0 to {len(parts) - 1}" if parts else "none: it is empty"
        )
    return parts[index]
