"""glTF 2.0: every primitive mode, type of number, colour, stride, sparse part, placement and container."""

from __future__ import annotations

import base64
import itertools
from collections.abc import Callable
from typing import Any
from urllib.parse import quote_from_bytes

from tests.io.corpus.gltf_document import Document, packed
from tests.io.corpus.item import Item

POINTS = [(float(x), float(y), (x * y % 3) / 4) for x in range(4) for y in range(3)]
CORNERS = [0, 1, 3, 4, 3, 1, 5, 4, 2, 8, 7, 11]
MODES = ("points", "lines", "loop", "line-strip", "triangles", "strip", "fan")
TURN = [0.5, -0.5, 0.5, 0.5]


def plain(**more: Any) -> Document:
    """One mesh of triangles."""
    document = Document()
    return document.primitive(document.accessor(POINTS, 5126), document.indices(CORNERS), **more)


def coloured(kind: int, width: int, largest: float, normalized: bool) -> Document:
    document = Document()
    shades = [tuple(type(largest)(largest * (k * n % 7) / 6) for n in (1, 2, 3, 4)[:width]) for k in range(len(POINTS))]
    color = document.accessor(shades, kind, 4 * -(-width * {5121: 1, 5123: 2}.get(kind, 4) // 4), normalized=normalized)
    return document.primitive(document.accessor(POINTS, 5126, 20), document.indices(CORNERS), color)


def _modes() -> list[Item]:
    found = []
    for (mode, name), kind in itertools.product(enumerate(MODES), (None, 5121, 5123, 5125)):
        document = Document()
        indices = None if kind is None else document.indices(CORNERS, kind)
        document.primitive(document.accessor(POINTS, 5126), indices, mode=mode)
        refusal = None if mode > 3 else "allowed: 4 to 6, triangles"
        found.append(Item(f"mode-{name}-{kind}.glb", document.glb(), refusal))
        beside = plain().primitive(0, None, mode=mode)
        found.append(Item(f"beside-{name}-{kind}.gltf", beside.gltf(), refusal))
    return found


def _numbers() -> list[Item]:
    found = []
    for kind, largest in ((5121, 255), (5123, 65535), (5126, 1.0), (5120, 127), (5122, 32767), (5125, 2**32 - 1)):
        for width, normalized in itertools.product((3, 4), (False, True)):
            good = (kind, normalized) in ((5121, True), (5123, True), (5126, False))
            data = coloured(kind, width, largest, normalized).glb()
            found.append(Item(f"colour-{kind}-{width}-{normalized}.glb", data, None if good else "COLOR_0"))
    for kind, normalized in itertools.product((5120, 5121, 5122, 5123), (False, True)):
        document = Document()
        document.tree["extensionsRequired"] = ["KHR_mesh_quantization"]
        low = 0 if kind in (5121, 5123) else -128
        points = [(40 * x + low // 8, 127 * y // 2, low if x == 3 else 9) for x in range(4) for y in range(3)]
        position = document.accessor(points, kind, 4 if kind < 5122 else 8, normalized=normalized)
        found.append(Item(f"quantized-{kind}-{normalized}.glb", document.primitive(position).glb()))
    return found


def _sparse() -> list[Item]:
    found = []
    for kind, based in itertools.product((5121, 5123, 5125), (True, False)):
        document = Document()
        sparse = {
            "count": 3,
            "indices": {"bufferView": document.view(packed([(1,), (4,), (11,)], kind)), "componentType": kind},
            "values": {"bufferView": document.view(packed([(1, 2, 3), (4, 5, 6), (7, 8, 9)], 5126))},
        }
        if based:
            position = document.accessor(POINTS, 5126, 16, sparse=sparse)
        else:
            position = document.described(len(POINTS), 3, 5126, sparse=sparse)
        found.append(Item(f"sparse-{kind}-{based}.glb", document.primitive(position, document.indices(CORNERS)).glb()))
        rows = document.tree["bufferViews"][0]
        document.data = document.data.replace(packed([(1,), (4,)], kind), packed([(4,), (1,)], kind), 1)
        found.append(Item(f"sparse-{kind}-{based}-unordered.glb", document.glb(), "rising"))
        rows["byteLength"] -= 1
        found.append(Item(f"sparse-{kind}-{based}-short.glb", document.glb(), "sparse"))
    document = Document()
    sparse = {
        "count": 2,
        "indices": {"bufferView": document.view(packed([(0,), (5,)], 5121)), "componentType": 5121},
        "values": {"bufferView": document.view(packed([(7,), (9,)], 5123))},
    }
    indices = document.described(6, 1, 5123, sparse=sparse)
    found.append(Item("sparse-indices.gltf", document.primitive(document.accessor(POINTS, 5126), indices).gltf()))
    return found


def _nodes() -> list[Item]:
    matrix = [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1]
    trees: dict[str, tuple[list[dict[str, Any]], str | None]] = {
        "moved": ([{"mesh": 0, "translation": [1, 2.5, -3]}], None),
        "turned": ([{"mesh": 0, "rotation": TURN, "translation": [1, 0, 0]}], None),
        "any-turn": ([{"mesh": 0, "rotation": [0.18257419, 0.36514837, 0.54772256, 0.73029674]}], None),
        "scaled": ([{"mesh": 0, "scale": [1, 2, 0.5], "rotation": TURN}], None),
        "mirrored": ([{"mesh": 0, "scale": [-1, 1, 1]}], None),
        "twice-mirrored": ([{"scale": [1, -1, 1], "children": [1]}, {"mesh": 0, "scale": [1, 1, -2]}], None),
        "flattened": ([{"mesh": 0, "scale": [1, 1, 0]}], None),
        "matrix": ([{"mesh": 0, "matrix": matrix}], None),
        "mirroring-matrix": ([{"mesh": 0, "matrix": [-v if k == 10 else v for k, v in enumerate(matrix)]}], None),
        "nested": ([{"children": [1, 2], "rotation": TURN}, {"mesh": 0, "scale": [2, 2, 2]},
                    {"translation": [0, 0, 9], "children": [3]}, {"mesh": 0, "matrix": matrix}], None),
        "loop": ([{"mesh": 0, "children": [1]}, {"children": [0]}], "nodes.0"),
        "two-parents": ([{"children": [1, 2]}, {"children": [2]}, {"mesh": 0}], "nodes.2"),
        "no-child": ([{"mesh": 0, "children": [7]}], "nodes.7"),
        "no-mesh": ([{"mesh": 3}], "meshes.3"),
        "empty": ([{}], "no mesh"),
        "perspective": ([{"mesh": 0, "matrix": [*matrix[:3], 1, *matrix[4:]]}], "0, 0, 0, 1"),
        "both": ([{"mesh": 0, "matrix": matrix, "scale": [1, 1, 1]}], "matrix"),
        "long-quaternion": ([{"mesh": 0, "rotation": [1, 1, 0, 0]}], "length 1"),
        "zero-quaternion": ([{"mesh": 0, "rotation": [0, 0, 0, 0]}], "length 1"),
        "short-matrix": ([{"mesh": 0, "matrix": matrix[:15]}], "nodes.0.matrix"),
        "overflowing": ([{"mesh": 0, "scale": [1e308, 1, 1], "translation": [1e308, 0, 0]}], "finite"),
        "skin": ([{"mesh": 0, "skin": 0}], "skin"),
        "weights": ([{"mesh": 0, "weights": [0, 0.5]}], "weights"),
        "no-weights": ([{"mesh": 0, "weights": [0, 0.0]}], None),
        "instances": ([{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {}}}], "EXT_mesh_gpu_instancing"),
        "lit": ([{"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}], None),
    }  # fmt: skip
    found = []
    for name, (nodes, refusal) in trees.items():
        document = plain()
        document.tree["nodes"] = nodes
        found.append(Item(f"node-{name}.glb", document.glb(), refusal))
    for key, value, refusal in (("scenes", [], None), ("scene", 1, "scenes.1"), ("scenes", [{}], "no mesh")):
        document = plain()
        document.tree[key] = value
        found.append(Item(f"scene-{key}-{len(str(value))}.glb", document.glb(), refusal))
    document = plain().primitive(0, 1, mode=5).primitive(0, None, mode=6)
    color = document.accessor([(k / 16, 0.5, 1.0) for k in range(len(POINTS))], 5126)
    found.append(Item("some-coloured.glb", document.primitive(0, 1, color).glb()))
    return found


def _containers() -> list[Item]:
    document, text = plain(), plain().gltf()
    bare = "data:," + quote_from_bytes(document.data)
    found = [
        Item("glb.glb", document.glb()), Item("chunks.glb", document.glb((b"ABCD", b"1234"))),
        Item("glb-as.gltf", document.glb()), Item("mark.gltf", b"\xef\xbb\xbf" + text),
        Item("percent.gltf", document.gltf(bare)), Item("capital.gltf", document.gltf(bare.replace("data", "DATA"))),
        Item("external.gltf", document.gltf("numbers.bin"), None, (("numbers.bin", document.data),)),
        Item("longer.gltf", document.gltf("longer.bin"), None, (("longer.bin", document.data + b"more"),)),
        Item("spaces.gltf", document.gltf("a%20b%C3%A9.bin"), None, (("a bé.bin", document.data),)),
        Item("shorter.gltf", document.gltf("short.bin"), "buffers.0", (("short.bin", document.data[:-1]),)),
        Item("missing.gltf", document.gltf("none.bin"), "No such file"),
        Item("long-name.gltf", document.gltf("n" * 9999), "buffers.0.uri"),
    ]  # fmt: skip
    for k, uri in enumerate(("../numbers.bin", "%2e%2e/numbers.bin", "x/../../numbers.bin", "/etc/hosts", "file:///a",
                             "http://example.org/a.bin", "C:/a.bin", "..\\numbers.bin", "", "a%00b", "data:x",
                             "data:;base64,*", "data:;base64,AAA")):  # fmt: skip
        found.append(Item(f"uri-{k}.gltf", document.gltf(uri), "buffers.0"))
    whole = document.glb()
    for name, data in (("version", whole[:4] + b"\1" + whole[5:]), ("cut", whole[:-4]), ("more", whole + b"1234"),
                       ("chunk", whole[:12] + b"\xff\xff\xff\x7f" + whole[16:]), ("head", whole[:10]),
                       ("order", whole.replace(b"JSON", b"json"))):  # fmt: skip
        found.append(Item(f"container-{name}.glb", data, "found"))
    return found


def _changed(change: Callable[[dict[str, Any]], object]) -> bytes:
    document = plain()
    change(document.tree)
    return document.glb()


def _documents() -> list[Item]:
    found = []
    for name in (
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "KHR_meshopt_compression",
        "MSFT_lod",
        "X_" * 999,
    ):
        found.append(
            Item(f"required-{name[:9]}.glb", _changed(lambda t, n=name: t.update(extensionsRequired=[n])), name[:9])
        )
    for name in ("KHR_materials_unlit", "KHR_texture_transform", "KHR_texture_basisu", "KHR_lights_punctual"):
        found.append(Item(f"harmless-{name}.glb", _changed(lambda t, n=name: t.update(extensionsRequired=[n]))))
    accessor, view = (lambda t: t["accessors"][0]), (lambda t: t["bufferViews"][0])
    primitive = lambda t: t["meshes"][0]["primitives"][0]  # noqa: E731
    draco = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}}
    changes: list[tuple[Callable[[dict[str, Any]], object], str]] = [
        (lambda t: t["asset"].update(version="1.0"), "asset.version"), (lambda t: t.pop("asset"), "asset"),
        (lambda t: t["asset"].update(minVersion="2.1"), "minVersion"),
        (lambda t: accessor(t).update(count=13), "accessors.0"), (lambda t: accessor(t).update(count=2**40), "accessors"),
        (lambda t: accessor(t).update(count=0), "accessors.0.count"), (lambda t: accessor(t).update(count=-1), "-1"),
        (lambda t: accessor(t).update(count=12.0), "count"), (lambda t: accessor(t).update(count="12"), "count"),
        (lambda t: accessor(t).update(componentType=5124), "5124"), (lambda t: accessor(t).update(type="VEC2"), "VEC2"),
        (lambda t: accessor(t).update(type="VEC4"), "VEC4"), (lambda t: accessor(t).update(byteOffset=4), "accessors.0"),
        (lambda t: accessor(t).update(byteOffset=-4), "byteOffset"),
        (lambda t: accessor(t).update(normalized=True), "normalized"),
        (lambda t: accessor(t).update(bufferView=9), "bufferViews.9"), (lambda t: view(t).update(buffer=1), "buffers.1"),
        (lambda t: view(t).update(byteStride=8), "accessors.0"), (lambda t: view(t).update(byteStride=2), "byteStride"),
        (lambda t: view(t).update(byteLength=2**50), "bufferViews.0"),
        (lambda t: view(t).update(byteOffset=2**50), "bufferViews.0"),
        (lambda t: t["accessors"][1].update(count=11), "11 corners"),
        (lambda t: t["accessors"][1].update(count=3, type="VEC3"), "SCALAR"),
        (lambda t: t["accessors"][1].update(componentType=5122), "5122"), (lambda t: primitive(t).update(mode=7), "mode"),
        (lambda t: primitive(t).update(indices=9), "accessors.9"),
        (lambda t: primitive(t)["attributes"].clear(), "POSITION"),
        (lambda t: t.update(meshes=[]), "meshes.0"), (lambda t: t["meshes"][0].update(primitives=[]), "primitives"),
        (lambda t: t["meshes"][0].update(weights=[1.0]), "weights"), (lambda t: t.update(nodes={}), "nodes"),
        (lambda t: (accessor(t).pop("bufferView"), primitive(t).update(extensions=draco)), "KHR_draco_mesh_compression"),
        (lambda t: (accessor(t).pop("bufferView"), accessor(t).update(count=2**31)), "count"),
    ]  # fmt: skip
    found += [Item(f"changed-{k}.glb", _changed(change), words) for k, (change, words) in enumerate(changes)]
    found.append(Item("draco-with-fallback.glb", _changed(lambda t: primitive(t).update(extensions=draco))))
    for name, points, corners, words in (
        ("beyond", POINTS, [0, 1, 12], "found 12"), ("restart", POINTS, [0, 1, 65535], "65535"),
        ("restart-there", POINTS * 5500, [0, 1, 65535], "65535"), ("few", POINTS, [0, 1], "2 corners"),
        ("not-finite", [*POINTS[:11], (0.0, float("nan"), 0.0)], CORNERS, "finite"),
    ):  # fmt: skip
        document = Document()
        document.primitive(document.accessor(points, 5126), document.indices(corners))
        found.append(Item(f"corners-{name}.glb", document.glb(), words))
    document = plain()
    document.primitive(0, 1, document.accessor([(0.5, 0.5, 0.5)] * 11, 5126))
    found.append(Item("too-few-colours.glb", document.glb(), "COLOR_0"))
    document = plain()
    document.primitive(0, 1, document.accessor([(0.5, 0.5, 1.5)] * 12, 5126))
    found.append(Item("bright.glb", document.glb(), "1.5"))
    found.append(Item("base64.gltf", plain().gltf("data:x/y;base64," + base64.b64encode(plain().data).decode())))
    return found


def items() -> list[Item]:
    return [item for part in (_modes, _numbers, _sparse, _nodes, _containers, _documents) for item in part()]
