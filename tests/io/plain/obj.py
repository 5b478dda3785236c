"""Wavefront OBJ."""

from __future__ import annotations

from tests.io.plain.surface import Corner, Refused, Surface, assembled, need, number, whole

_BESIDE = {b"vt", b"vn", b"vp", b"g", b"o", b"s", b"mg", b"usemtl", b"mtllib", b"usemap", b"maplib", b"bevel"}
_BESIDE |= {b"c_interp", b"d_interp", b"lod", b"shadow_obj", b"trace_obj", b"ctech", b"stech"}


def read(data: bytes) -> Surface:
    points: list[Corner] = []
    colors: list[Corner] = []
    polygons: list[list[int]] = []
    if data[:3] == bytes([0xEF, 0xBB, 0xBF]):
        data = data[3:]
    pending: list[bytes] = []
    for line in data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n"):
        hash_at = line.find(b"#")
        line = (line if hash_at < 0 else line[:hash_at]).strip()
        if line[-1:] == b"\\":
            pending += line[:-1].split()
            continue
        _statement(pending + line.split(), points, colors, polygons)
        pending = []
    _statement(pending, points, colors, polygons)
    need(not colors or len(colors) == len(points), "some have no colour")
    return assembled(points, colors or None, polygons)


def _statement(words: list[bytes], points: list[Corner], colors: list[Corner], polygons: list[list[int]]) -> None:
    if not words or words[0] in _BESIDE:
        return
    if words[0] == b"v":
        values = tuple(number(word) for word in words[1:])
        if len(values) in (3, 4):
            points.append(values[:3])
        elif len(values) in (6, 7):
            points.append(values[:3])
            colors.append(values[len(values) - 3 :])
        else:
            raise Refused("v")
    elif words[0] == b"f":
        polygon = []
        for word in words[1:]:
            parts = word.split(b"/")
            need(len(parts) <= 3, "corner")
            for extra in parts[1:]:
                need(extra == b"" or whole(extra) != 0, "corner")
            k = whole(parts[0])
            need(k != 0, "corner 0")
            polygon.append(k - 1 if k > 0 else len(points) + k)
            need(polygon[-1] >= 0, "before the first")
        polygons.append(polygon)
    else:
        raise Refused(f"statement {words[0]!r}")
