"""STL."""

from __future__ import annotations

import struct

from tests.io.corpus.item import Item

TRIANGLES = [[(k, 0, 0), (k + 1, 0.5, 0), (k, 1, 0.25 * k)] for k in range(5)]


def binary(header: bytes, count: int | None = None) -> bytes:
    data = header.ljust(80, b" ") + struct.pack("<I", len(TRIANGLES) if count is None else count)
    for triangle in TRIANGLES:
        data += struct.pack("<12fH", 0, 0, 1, *sum(triangle, ()), 0xFFFF)
    return data


def text(name: str = "a b endsolid") -> str:
    facets = "".join(
        "  facet normal 0 0 1\n    outer loop\n"
        + "".join("      vertex {} {} {:e}\n".format(*corner) for corner in triangle)
        + "    endloop\n  endfacet\n"
        for triangle in TRIANGLES
    )
    return f"solid {name}\n{facets}endsolid {name}\n"


READ = {
    "text": text(),
    "nameless": text(""),
    "windows": text().replace("\n", "\r\n"),
    "classic": text().replace("\n", "\r"),
    "capitals": text().upper(),
    "flat-text": text().replace("  ", ""),
    "blank-lines": "\n \n" + text().replace("\n", "\n\n"),
    "two-solids": text() + text("two"),
    "no-normals": text().replace("normal 0 0 1", "normal nan -nan(ind) 1.#QNAN"),
}
REFUSED = {
    "lost-vertex": (text().replace("      vertex 2 0 0.000000e+00\n", ""), "allowed: vertex and 3 numbers"),
    "lost-vertices": (text().replace("      vertex 2 ", "#"), "allowed: vertex"),
    "more-vertices": (text().replace("    endloop", "      vertex 1 2 3\n    endloop", 1), "allowed: endloop"),
    "lost-number": (text().replace("vertex 2 0 ", "vertex 2 ", 1), "line 18"),
    "lost-endloop": (text().replace("    endloop\n", "", 1), "allowed: endloop"),
    "lost-endfacet": (text().replace("  endfacet\n", "", 1), "allowed: endfacet"),
    "lost-facet": (text().replace("  facet normal 0 0 1\n", "", 1), "line 2"),
    "lost-end": (text().rsplit("endsolid", 1)[0].rsplit("endsolid", 1)[0], "the end of the file"),
    "garbage-behind": (text() + "x", "allowed: solid"),
    "underscore": (text().replace("vertex 2 0 ", "vertex 2_0 0 ", 1), "2_0"),
    "infinite": (text().replace("vertex 2 0 ", "vertex inf 0 ", 1), "finite"),
    "empty": ("solid\nendsolid\n", "V >= 1"),
}


def items() -> list[Item]:
    found = [Item(f"{name}.stl", data.encode()) for name, data in READ.items()]
    found += [Item(f"{name}.stl", data.encode(), words) for name, (data, words) in REFUSED.items()]
    found += [
        Item(f"binary-{k}.stl", binary(head)) for k, head in enumerate((b"", b"solid x", b"solid\nfacet endsolid"))
    ]
    found += [Item(f"count-{n}.stl", binary(b"solid endsolid", n), "solid") for n in (0, 4, 6, 2**31, 2**32 - 1)]
    found += [Item(f"longer-{n}.stl", binary(b"x") + bytes(n), f"found {334 + n} bytes") for n in (1, 50)]
    found.append(Item("cut.stl", binary(b"x")[:-1], "found 333 bytes"))
    return found
