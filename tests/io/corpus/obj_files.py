"""Wavefront OBJ."""

from __future__ import annotations

from tests.io.corpus.item import Item
from tests.io.corpus.polygons import CROSSING, PLANES, shapes

POINTS = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nv .5 -2e-1 +3.\n"
BODY = POINTS + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nf 1 2 3 4\nf 5 2 1\n"

READ = {
    "texture": BODY.replace("f 1 2 3 4", "f 1/1 2/2 3/3 4/1"),
    "normal": BODY.replace("f 1 2 3 4", "f 1//1 2//1 3//1 4//1"),
    "both": BODY.replace("f 1 2 3 4", "f 1/1/1 2/2/1 3/3/1 4/1/1"),
    "negative": BODY.replace("f 1 2 3 4", "f -5 -4 -3/-1 -2//-1"),
    "windows": BODY.replace("\n", "\r\n"),
    "classic": BODY.replace("\n", "\r"),
    "mark": "\ufeff" + BODY,
    "continued": BODY.replace("v 1 1 0.5", "v 1 \\\n1 \\\r\n 0.5").replace("2 3 4", "2 3\\\n 4"),
    "continued-end": BODY.rstrip().removesuffix(" 1") + " 1 \\",
    "comments": "# f 1 2 3\n" + BODY.replace("\nf", " # \\\nf"),
    "tabs": BODY.replace(" ", "\t"),
    "groups": "mtllib a b.mtl\no \xe9\n" + BODY.replace("f 5", "g x y\ns off\nusemtl # none\nf 5"),
    "weights": BODY.replace("v 1 0 0", "v 1 0 0 2"),
    "colours": "".join(f"v {x} {y} {x * y} {x / 4} {y / 4} 0.{x}\n" for x in range(4) for y in range(4))
    + "f 1 2 6 5\n",
    "forward": "f 1 2 3\n" + POINTS,
    "repeated": POINTS + "f 1 1 2 3\nf 1 2 3 3\nf 2 3 4 2\n",
    "collinear": POINTS + "v 2 0 0\nv 3 0 0\nf 1 2 6 7\nf 1 3 4\n",
}
REFUSED = {
    "underscore": (BODY.replace("v 1 0 0", "v 1_0 0 0"), "'v 1_0 0 0' in line 2"),
    "underscored-corner": (BODY.replace("f 5 2 1", "f 5 1_ 1"), "line 11"),
    "underscored-texture": (BODY.replace("f 5 2 1", "f 5 2/1_0 1"), "line 11"),
    "hexadecimal": (BODY.replace("v 1 0 0", "v 0x1p0 0 0"), "line 2"),
    "comma": (BODY.replace("v 1 0 0", "v 1,5 0 0"), "line 2"),
    "no-number": (BODY.replace("v 1 0 0", "v nan 0 0"), "finite"),
    "infinite": (BODY.replace("v 1 0 0", "v 1e400 0 0"), "finite"),
    "zero": (BODY.replace("f 5 2 1", "f 5 0 1"), "line 11"),
    "behind": (BODY.replace("f 5 2 1", "f 5 -6 1"), "line 11"),
    "beyond": (BODY.replace("f 5 2 1", "f 5 2 6"), "found 5, allowed: indices from 0 to 4"),
    "beyond-polygon": (BODY.replace("f 1 2 3 4", "f 1 2 3 999999999"), "indices from 0 to 4"),
    "too-many-parts": (BODY.replace("f 5 2 1", "f 5/1/1/1 2 1"), "line 11"),
    "words-in-texture": (BODY.replace("f 5 2 1", "f 5/x 2 1"), "line 11"),
    "line": (BODY + "l 1 2\n", "'l 1 2' in line 12"),
    "point": (BODY + "p 1\n", "line 12"),
    "free-form": (BODY + "curv 0 1 1 2\n", "line 12"),
    "unknown": (BODY + "F 1 2 3\n", "'F 1 2 3' in line 12"),
    "two": (BODY + "f 1 2\n", "line 12"),
    "half-coloured": (BODY.replace("v 1 0 0", "v 1 0 0 1 1 1"), "1 vertex colours"),
    "bright": (POINTS.replace("\n", " 0 0 255\n") + "f 1 2 3\n", "255"),
    "no-faces": (POINTS, "T >= 1"),
}


def items() -> list[Item]:
    found = [Item(f"{name}.obj", text.encode()) for name, text in READ.items()]
    found += [Item(f"{name}.obj", text.encode(), words) for name, (text, words) in REFUSED.items()]
    found.append(Item("utf-16.obj", BODY.encode("utf-16"), "line 1"))
    found += [Item(f"polygon-{name}.obj", polygon_text(corners)) for name, corners in shapes().items()]
    for name, corners in CROSSING.items():
        for where in ("xy", "slanted", "huge"):
            text = polygon_text([PLANES[where](x, y) for x, y in corners])
            found.append(Item(f"crossing-{name}-{where}.obj", text, "crosses itself"))
    return found


def polygon_text(corners: list[tuple[float, ...]]) -> bytes:
    """A polygon behind a triangle of its own."""
    text = "v 5 5 5\nv 6 5 5\nv 5 6 5\nf 1 2 3\n" + "".join("v {!r} {!r} {!r}\n".format(*corner) for corner in corners)
    return (text + "f " + " ".join(str(k + 4) for k in range(len(corners))) + "\nf 3 2 1\n").encode()
