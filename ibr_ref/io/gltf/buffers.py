"""The bytes of a glTF document: those behind its text in a .glb, in the text, and in files beside it."""

from __future__ import annotations

import base64
import struct
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

from ibr_ref.io.files import contents
from ibr_ref.io.gltf.document import Document, member, refused, shortened
from ibr_ref.scene.checks import named

_MAGIC, _JSON, _BINARY = b"glTF", 0x4E4F534A, 0x004E4942
_HEADER, _CHUNK = 12, 8
"""Bytes."""


def split(data: bytes) -> tuple[bytes, bytes | None]:
    """A document's text, and the bytes behind it in a .glb.

    Raises ValueError for a .glb that is cut off, longer than it says, or of another version.
    """
    if not data.startswith(_MAGIC):
        return data, None
    if len(data) < _HEADER:
        raise refused("the file", f"{len(data)} bytes", f"{_HEADER} or more")
    version, length = struct.unpack_from("<II", data, len(_MAGIC))
    if version != 2:
        raise refused("the version of the file", version, "2")
    if length != len(data):
        raise refused("the file", f"{len(data)} bytes", f"{length}, as its header says")
    chunks, place = list[tuple[int, bytes]](), _HEADER
    while place < length:
        size, kind = struct.unpack_from("<II", data, place) if place + _CHUNK <= length else (length, 0)
        place += _CHUNK
        if place + size > length:
            raise refused(f"chunk {len(chunks)}", f"{max(length - place, 0)} bytes", f"{size}, as its header says")
        chunks.append((kind, data[place : place + size]))
        place += size
    if not chunks or chunks[0][0] != _JSON:
        raise refused("the first chunk", "no JSON", "JSON")
    return chunks[0][1], chunks[1][1] if len(chunks) > 1 and chunks[1][0] == _BINARY else None


class Buffers:
    """The buffers of a document, each read when it is first needed."""

    def __init__(self, document: Document, binary: bytes | None, path: Path) -> None:
        self._document, self._binary, self._path = document, binary, path
        self._read: dict[int, memoryview] = {}

    def view(self, index: int) -> memoryview:
        """The bytes of a buffer view. Raises ValueError for what is not there."""
        view = member(self._document.bufferViews, index, "bufferViews")
        if "EXT_meshopt_compression" in view.extensions and self._is_placeholder(view.buffer):
            raise refused(f"bufferViews.{index}", "EXT_meshopt_compression", "bytes as they are")
        data = self._buffer(view.buffer)
        end = view.byteOffset + view.byteLength
        if end > len(data):
            raise refused(f"bufferViews.{index}", f"bytes up to {end}", f"up to {len(data)}, as its buffer has")
        return data[view.byteOffset : end]

    def _is_placeholder(self, index: int) -> bool:
        """Whether a buffer stands for bytes that only an extension makes."""
        return member(self._document.buffers, index, "buffers").uri is None and (index > 0 or self._binary is None)

    def _buffer(self, index: int) -> memoryview:
        if index not in self._read:
            buffer = member(self._document.buffers, index, "buffers")
            data = self._bytes(index, buffer.uri)
            if len(data) < buffer.byteLength:
                raise refused(f"buffers.{index}", f"{len(data)} bytes", f"{buffer.byteLength}, as the document says")
            self._read[index] = memoryview(data)[: buffer.byteLength]
        return self._read[index]

    def _bytes(self, index: int, uri: str | None) -> bytes:
        if uri is None:
            if index or self._binary is None:
                raise refused(f"buffers.{index}.uri", "nothing", "data, or the name of a file")
            return self._binary
        if uri[:5].lower() == "data:":
            return _embedded(index, uri)
        name = unquote(uri)
        parts = name.split("/")
        if ".." in parts or not name or name.startswith("/") or any(c in name for c in "\\:\0"):
            raise refused(f"buffers.{index}.uri", repr(shortened(uri)), "data, or a file in the folder of the document")
        path = self._path.parent / name
        try:
            return contents(path)
        except (OSError, ValueError) as error:
            reason = str(error).removeprefix(f"{named(path)}: ")
            raise ValueError(f"buffers.{index}.uri: {shortened(repr(uri))} {reason}") from None


def _embedded(index: int, uri: str) -> bytes:
    """The bytes of a `data:` URI."""
    head, comma, body = uri.partition(",")
    try:
        if not comma:
            raise ValueError
        if head.lower().endswith(";base64"):
            return base64.b64decode(unquote(body), validate=True)
        return unquote_to_bytes(body)
    except ValueError:
        allowed = "data:[type][;base64],DATA"
        raise refused(f"buffers.{index}.uri", repr(uri[:40] + "..."), allowed) from None
