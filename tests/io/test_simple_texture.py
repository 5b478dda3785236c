"""SimpleTexture files: round trips, the standard's fields and defaults, and one clear error for what is unsafe or odd."""

import dataclasses
import math
import os
import time

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ibr_ref import Camera, DepthImage, io
from tests.io import png_writer
from tests.io.test_images import check_refused, shared, small

STEPS = 65534.0
COLORS = np.arange(36, dtype=np.uint8).reshape(3, 4, 3) * 7
CODES = np.array([[1, 255, 0, 17], [128, 0, 0, 254], [2, 3, 4, 5]], np.uint8)
PLACED = {"position": (1, 2, 3), "orientation": (0, 1, 0, 0.5), "field_of_view": (1.2, 0.9), "near": 0.5, "far": 20.0,
          "width": 4, "height": 3}  # fmt: skip

NODE = """<DepthImage {fields}><diTexture><SimpleTexture>
<texture><ImageTexture url="color.png"/></texture><depth><ImageTexture url="depth.png"/></depth>
</SimpleTexture></diTexture></DepthImage>"""
FIELDS = (
    'position="1 2 3" orientation="0 1 0 0.5" fieldOfView="1.2 0.9" nearPlane="0.5" farPlane="20" orthographic="false"'
)
TEXT = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<XMT-A xmlns="urn:mpeg:mpeg4:xmta:schema:2002"><Header/><Body><Replace><Scene>'
    f"<Group><children>{NODE.format(fields=FIELDS)}</children></Group></Scene></Replace></Body></XMT-A>"
)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """One folder for all examples of a Hypothesis test."""
    return tmp_path_factory.mktemp("simple_texture")


def put(folder, text=TEXT, *, colors=COLORS, codes=CODES, bits=8):
    (folder / "color.png").write_bytes(png_writer.encode(colors, 8))
    (folder / "depth.png").write_bytes(png_writer.encode(codes, bits))
    path = folder / "set.xmt"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def image_of(camera, mask=None, seed=0):
    rng = np.random.default_rng(seed)
    shape = camera.height, camera.width
    depth = rng.uniform(max(camera.near, 1e-3), camera.far, shape)
    return DepthImage(color=rng.integers(0, 256, (*shape, 3)) / 255.0, depth=depth, camera=camera, mask=mask)


def back(folder, *images):
    io.write_simple_texture(folder / "set.xmt", images)
    return io.read_simple_texture(folder / "set.xmt")


def check_same_image(read, written):
    step = (written.camera.far - written.camera.near) / STEPS
    np.testing.assert_array_equal(read.mask, written.mask)
    np.testing.assert_array_equal(read.color, written.color)
    assert np.abs(read.depth - written.depth).max() <= 0.5 * step * (1.0 + 1e-9)
    assert not read.depth[~read.mask].any()


def check_same_camera(read, written):
    for name in ("view_from_world", "clip_from_view", "near", "far", "width", "height", "eye", "intrinsics"):
        np.testing.assert_array_equal(getattr(read, name), getattr(written, name), name)
    assert read.afx == written.afx


# Round trips


numbers = st.floats(-100.0, 100.0)
axes = st.tuples(numbers, numbers, numbers, st.floats(-7.0, 7.0))


@small
@given(
    position=st.tuples(numbers, numbers, numbers),
    orientation=axes,
    field_of_view=st.tuples(st.floats(0.01, 3.0), st.floats(0.01, 3.0)),
    orthographic=st.booleans(),
    near=st.floats(0.001, 10.0),
    length=st.floats(0.01, 1000.0),
    mask=arrays(bool, (3, 4)),
)
def test_afx_cameras_come_back_to_the_last_bit(
    place, position, orientation, field_of_view, orthographic, near, length, mask
):
    assume(any(orientation[:3]))
    camera = Camera.axis_angle(
        position=position, orientation=orientation, field_of_view=field_of_view, orthographic=orthographic, near=near,
        far=near + length, width=4, height=3,
    )  # fmt: skip
    image = image_of(camera, mask)
    (read,) = back(place, image)
    check_same_image(read, image)
    check_same_camera(read.camera, camera)


@small
@given(eye=st.tuples(numbers, numbers, numbers), target=st.tuples(numbers, numbers, numbers), data=st.data())
def test_other_cameras_come_back_to_rounding(place, eye, target, data):
    assume(np.linalg.norm(np.subtract(eye, target)) > 1.0)
    assume(np.linalg.norm(np.cross(np.subtract(eye, target), (0, 0, 1))) > 0.1)
    common = {"eye": eye, "target": target, "near": 0.5, "far": 20.0, "width": 4, "height": 3}
    if data.draw(st.booleans()):
        camera = Camera.look_at(vertical_fov=data.draw(st.floats(1.0, 170.0)), **common)
        np.testing.assert_array_equal(back(place, image_of(camera))[0].camera.eye, camera.eye)
    else:
        camera = Camera.orthographic(view_height=data.draw(st.floats(0.1, 100.0)), **common)
    image = image_of(camera)
    (read,) = back(place, image)
    check_same_image(read, image)
    rotation, given_ = read.camera.view_from_world, camera.view_from_world
    np.testing.assert_allclose(rotation[:3, :3], given_[:3, :3], rtol=0, atol=4e-15)
    np.testing.assert_allclose(rotation[:3, 3], given_[:3, 3], rtol=0, atol=1e-12)
    np.testing.assert_allclose(read.camera.clip_from_view, camera.clip_from_view, rtol=1e-14, atol=0)
    np.testing.assert_allclose(read.camera.intrinsics, camera.intrinsics, rtol=1e-14, atol=0)
    np.testing.assert_allclose(read.camera.eye, camera.eye, rtol=0, atol=4e-15)


@pytest.mark.parametrize(
    "orientation",
    [(0, 0, 1, 0), (1, 0, 0, math.pi), (0, 1, 0, math.pi), (0, 0, 1, math.pi), (1, 1, 1, 3.14159), (3, -2, 1, 6.28)],
)
def test_half_turns_and_none_have_an_axis_too(tmp_path, orientation):
    """A camera without its AFX fields has only its matrix."""
    made = Camera.axis_angle(**{**PLACED, "orientation": orientation})
    camera = dataclasses.replace(made, far=30.0)
    assert camera.afx is None
    (read,) = back(tmp_path, image_of(camera))
    np.testing.assert_allclose(read.camera.view_from_world, camera.view_from_world, rtol=0, atol=4e-15)


def test_a_set_of_many_and_what_lies_in_the_folder(tmp_path):
    masks = np.random.default_rng(1).uniform(size=(3, 3, 4)) < 0.5
    cameras = [
        Camera.axis_angle(**{**PLACED, "orientation": (0, 1, 0, angle), "orthographic": angle > 2})
        for angle in (1, 2, 3)
    ]
    images = [image_of(camera, mask, i) for i, (camera, mask) in enumerate(zip(cameras, masks, strict=True))]
    for read, written in zip(back(tmp_path, *images), images, strict=True):
        check_same_image(read, written)
        np.testing.assert_array_equal(read.camera.view_from_world, written.camera.view_from_world)
    names = [f"set-{i:03d}-{kind}.png" for i in range(3) for kind in ("color", "depth")]
    assert sorted(path.name for path in tmp_path.iterdir()) == [*names, "set.xmt"]
    text = (tmp_path / "set.xmt").read_text()
    assert text.startswith('<?xml version="1.0" encoding="UTF-8"?>\n<XMT-A xmlns="urn:mpeg:mpeg4:xmta:schema:2002">')
    assert '<texture><ImageTexture url="&quot;set-002-color.png&quot;"/></texture>' in text
    assert text.count("<DepthImage position=") == 3


def test_what_was_read_is_written_as_it_was(tmp_path):
    first, second = tmp_path / "first", tmp_path / "second"
    first.mkdir()
    second.mkdir()
    mask = np.eye(3, 4, dtype=bool)
    io.write_simple_texture(
        first / "set.xmt", [image_of(Camera.look_at(eye=(3, 1, 2), target=(0, 0, 0), width=4, height=3), mask)]
    )
    io.write_simple_texture(second / "set.xmt", io.read_simple_texture(first / "set.xmt"))
    for path in first.iterdir():
        assert path.read_bytes() == (second / path.name).read_bytes()


def test_both_planes_are_coded_and_a_depth_just_past_them(tmp_path):
    camera = Camera.axis_angle(**PLACED)
    step = 19.5 / STEPS
    depth = np.full((3, 4), 10.0)
    depth[0] = 0.5, 20.0, 0.5 - 0.4 * step, 20.0 + 0.4 * step
    (read,) = back(tmp_path, DepthImage(color=np.zeros((3, 4, 3)), depth=depth, camera=camera))
    assert read.depth[0].tolist() == [0.5, 20.0, 0.5, 20.0]
    codes = io.read_image(tmp_path / "set-000-depth.png")[0] * 65535
    assert codes.tolist() == [65535, 1, 65535, 1]


def test_a_set_without_a_point(tmp_path):
    (read,) = back(tmp_path, image_of(Camera.axis_angle(**PLACED), np.zeros((3, 4), bool)))
    assert not read.mask.any()


def test_a_large_set_is_not_too_much_text(tmp_path):
    image = image_of(Camera.axis_angle(**{**PLACED, "width": 1, "height": 1}))
    assert len(back(tmp_path, *[image] * 200)) == 200


# What others write


def metric(codes, last, near=0.5, far=20.0):
    return np.where(codes > 0, near + (1.0 - (codes - 1.0) / (last - 1.0)) * (far - near), 0.0)


@pytest.mark.parametrize("bits", [8, 16])
def test_depth_codes_are_linear_and_bright_is_near(tmp_path, bits):
    codes = CODES if bits == 8 else CODES.astype(np.uint16) * 257
    (image,) = io.read_simple_texture(put(tmp_path, codes=codes, bits=bits))
    np.testing.assert_allclose(image.depth, metric(codes.astype(float), 2**bits - 1), rtol=1e-15)
    np.testing.assert_array_equal(image.mask, codes > 0)
    np.testing.assert_array_equal(image.color, COLORS / 255.0)
    if bits == 8:
        assert image.depth[0].tolist()[:3] == [20.0, 0.5, 0.0]


def test_the_camera_is_the_one_of_the_fields(tmp_path):
    (image,) = io.read_simple_texture(put(tmp_path))
    expected = Camera.axis_angle(**PLACED)
    check_same_camera(image.camera, expected)


def test_fields_that_are_left_out_have_the_standards_defaults(tmp_path):
    (image,) = io.read_simple_texture(put(tmp_path, TEXT.replace(FIELDS, "")))
    expected = Camera.axis_angle(
        position=(0, 0, 10), orientation=(0, 0, 1, 0), field_of_view=(0.785398, 0.785398), orthographic=True, near=10,
        far=100, width=4, height=3,
    )  # fmt: skip
    check_same_camera(image.camera, expected)
    np.testing.assert_allclose(image.depth, metric(CODES.astype(float), 255, 10.0, 100.0), rtol=1e-15)


def test_depths_in_the_alpha_of_the_colours(tmp_path):
    text = TEXT.replace('<depth><ImageTexture url="depth.png"/></depth>', "")
    path = put(tmp_path, text, colors=np.append(COLORS, CODES[..., None], axis=2))
    (image,) = io.read_simple_texture(path)
    np.testing.assert_allclose(image.depth, metric(CODES.astype(float), 255), rtol=1e-15)
    np.testing.assert_array_equal(image.color, COLORS / 255.0)
    put(tmp_path, text)
    with pytest.raises(ValueError, match=r"color\.png: found no alpha channel, allowed for depths"):
        io.read_simple_texture(path)


def test_a_photograph_and_depths_in_rgb_in_a_folder_below(tmp_path):
    (tmp_path / "images").mkdir()
    io.write_image(tmp_path / "images" / "a.jpg", COLORS / 255.0)
    text = TEXT.replace('"color.png"', "'\"images/a.jpg\"'")
    (image,) = io.read_simple_texture(put(tmp_path, text, codes=np.repeat(CODES[..., None], 3, axis=2)))
    assert np.abs(image.color - COLORS / 255.0).max() < 0.2
    np.testing.assert_array_equal(image.mask, CODES > 0)


SAME = {
    "no namespace": TEXT.replace(' xmlns="urn:mpeg:mpeg4:xmta:schema:2002"', ""),
    "a prefix": TEXT.replace("xmlns=", "xmlns:m=").replace("</", "</m:").replace("<", "<m:").replace("<m:/m:", "</m:")
    .replace("<m:?", "<?"),
    "schema location": TEXT.replace("<XMT-A", '<XMT-A xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
                                    'xsi:schemaLocation="urn:mpeg:mpeg4:xmta:schema:2002 xmt-a.xsd"'),
    "quotes": TEXT.replace('"color.png"', '"&quot;color.png&quot;"').replace('"depth.png"', "\" 'depth.png' \""),
    "commas and capitals": TEXT.replace("1.2 0.9", "1.2, 0.9").replace('"false"', '"FALSE"').replace("1 2 3", " 1,2\n3"),
    "numbers": TEXT.replace('"false"', '"0"').replace('"20"', '"2.0e1"'),
    "names": TEXT.replace("<DepthImage", '<DepthImage DEF="A"').replace("<SimpleTexture", '<SimpleTexture DEF="B"'),
    "comments": TEXT.replace("<DepthImage", "<!-- <DepthImage> & <!DOCTYPE -->\n<?odd?><DepthImage"),
    "a transform that moves nothing": TEXT.replace("<Group>", '<Transform DEF="T">').replace("</Group>", "</Transform>"),
    "others around": TEXT.replace("<children>", '<children><Viewpoint position="0 0 1"/><Group USE="G"/>'),
    "another vocabulary": TEXT.replace("<children>", '<children><DepthImage xmlns="urn:x"/>'),
    "byte order mark": b"\xef\xbb\xbf" + TEXT.encode(),
    "UTF-16": TEXT.replace("UTF-8", "UTF-16").encode("utf-16"),
}  # fmt: skip


@pytest.mark.parametrize("name", SAME)
def test_other_ways_to_write_the_same(tmp_path, name):
    (plain,) = io.read_simple_texture(put(tmp_path))
    (image,) = io.read_simple_texture(put(tmp_path, SAME[name]))
    np.testing.assert_array_equal(image.depth, plain.depth)
    np.testing.assert_array_equal(image.camera.view_from_world, plain.camera.view_from_world)
    np.testing.assert_array_equal(image.camera.clip_from_view, plain.camera.clip_from_view)


def test_nodes_come_in_the_order_of_the_file(tmp_path):
    nodes = [NODE.format(fields=FIELDS.replace('"1 2 3"', f'"{i} 0 0"')) for i in range(5)]
    text = TEXT.replace(
        NODE.format(fields=FIELDS),
        f"{nodes[0]}<Group><children>{nodes[1]}{nodes[2]}</children></Group>{nodes[3]}{nodes[4]}",
    )
    images = io.read_simple_texture(put(tmp_path, text))
    assert [image.camera.eye[0] for image in images] == [0, 1, 2, 3, 4]


# Bad XML


LAUGHS = "".join(f'<!ENTITY a{i + 1} "{f"&a{i};" * 10}">' for i in range(12))
UNSAFE = {
    "a document type": '<!DOCTYPE XMT-A>',
    "one from elsewhere": '<!DOCTYPE XMT-A SYSTEM "http://127.0.0.1:9/x.dtd">',
    "an entity": '<!DOCTYPE XMT-A [<!ENTITY near "0.5">]>',
    "an external entity": '<!DOCTYPE XMT-A [<!ENTITY x SYSTEM "file:///etc/passwd">]>',
    "a parameter entity": '<!DOCTYPE XMT-A [<!ENTITY % x SYSTEM "file:///etc/passwd"> %x;]>',
    "a billion laughs": f'<!DOCTYPE XMT-A [<!ENTITY a0 "laugh">{LAUGHS}]>',
}  # fmt: skip


@pytest.mark.parametrize("name", UNSAFE)
def test_document_types_are_refused(tmp_path, name):
    text = TEXT.replace("<XMT-A", UNSAFE[name] + "<XMT-A").replace("<children>", "<children>&x;&near;&a12;")
    start = time.perf_counter()
    check_refused(io.read_simple_texture, put(tmp_path, text), "found a document type ('XMT-A')", "without entities")
    assert time.perf_counter() - start < 2.0


def test_no_first_bytes_of_a_file_are_one(tmp_path):
    data = TEXT.encode()
    for size in range(0, len(data), 7):
        check_refused(io.read_simple_texture, put(tmp_path, data[:size]))


def with_node(old, new):
    assert old in TEXT
    return TEXT.replace(old, new)


BAD_XML = {
    "no XML": ("hello", "damaged or cut off"),
    "bytes": (b"\xff\x00" * 50, "damaged or cut off"),
    "an entity from nowhere": (with_node("<children>", "<children>&x;"), "undefined entity"),
    "not closed": (with_node("</Group>", ""), "mismatched tag"),
    "another root": (TEXT.replace("XMT-A", "X3D"), "found the root element", "X3D", "allowed: XMT-A"),
    "another root's vocabulary": (with_node("xmta:schema:2002", "xmto:schema:2002"), "found the root element"),
    "no nodes": (TEXT.replace("DepthImage", "OctreeImage"), "found no DepthImage"),
    "too much": (TEXT + "\n" * 2**22, "bytes, allowed for XML: up to 4194304"),
    "moved": (with_node("<Group>", '<Transform translation="0 0 1">').replace("</Group>", "</Transform>"),
              "found a DepthImage in a Transform", "world space"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD_XML)
def test_bad_files(tmp_path, name):
    text, *words = BAD_XML[name]
    check_refused(io.read_simple_texture, put(tmp_path, text), *words)


def test_no_such_file_and_no_file(tmp_path):
    check_refused(io.read_simple_texture, tmp_path / "none.xmt", "No such file")
    check_refused(io.read_simple_texture, tmp_path, "is a folder")
    check_refused(io.read_simple_texture, put(tmp_path, ""), "found 0 bytes")


def test_very_deep_files(tmp_path):
    text = "<XMT-A>" + "<Group>" * 100_000 + "</Group>" * 100_000 + "</XMT-A>"
    check_refused(io.read_simple_texture, put(tmp_path, text), "found no DepthImage")


BAD_NODES = {
    "position": ('"1 2 3"', '"1 2"', "position: found '1 2'", "3 finite numbers"),
    "position nan": ('"1 2 3"', '"1 2 nan"', "position: found", "finite"),
    "position text": ('"1 2 3"', '"here"', "position: found 'here'"),
    "orientation": ('"0 1 0 0.5"', '"0 1 0"', "orientation: found '0 1 0'", "4 finite numbers"),
    "no axis": ('"0 1 0 0.5"', '"0 0 0 0.5"', "orientation: found", "not zero"),
    "one angle": ('"1.2 0.9"', '"1.2"', "fieldOfView: found '1.2'", "2 finite numbers"),
    "degrees": ('"1.2 0.9"', '"45 45"', "field_of_view: found [45.0, 45.0]", "radians"),
    "near": ('nearPlane="0.5"', 'nearPlane=""', "nearPlane: found ''", "a finite number"),
    "swapped": ('nearPlane="0.5"', 'nearPlane="30"', "nearPlane, farPlane: found (30.0, 20.0)", "nearPlane < farPlane"),
    "same": ('nearPlane="0.5"', 'nearPlane="20"', "nearPlane, farPlane: found (20.0, 20.0)"),
    "near 0": ('nearPlane="0.5"', 'nearPlane="0"', "nearPlane, farPlane: found (0.0, 20.0)"),
    "near below 0": ('nearPlane="0.5" farPlane="20" orthographic="false"',
                     'nearPlane="-1" farPlane="20" orthographic="true"', "found (-1.0, 20.0)"),
    "a point in the eye": ('nearPlane="0.5" farPlane="20" orthographic="false"',
                           'nearPlane="0" farPlane="20" orthographic="true"', "depth[0, 1]: found 0.0", "> 0"),
    "orthographic": ('"false"', '"no"', "orthographic: found 'no'", "true or false"),
    "another field": ('nearPlane="0.5"', 'nearplane="0.5"', "found the field 'nearplane'", "nearPlane"),
    "used": ("<DepthImage", '<DepthImage USE="A"', "found DepthImage USE='A'", "a node of its own"),
    "texture used": ("<SimpleTexture>", '<SimpleTexture USE="A">', "found SimpleTexture USE='A'"),
    "image used": ('<ImageTexture url="color.png"', '<ImageTexture USE="A"', "found ImageTexture USE='A'"),
    "no diTexture": ("diTexture", "texture", "diTexture: found nothing", "one SimpleTexture"),
    "a point texture": ("SimpleTexture", "PointTexture", "diTexture: found PointTexture", "one SimpleTexture"),
    "two": ("<diTexture>", "<diTexture><SimpleTexture/>", "found SimpleTexture, SimpleTexture", "one SimpleTexture"),
    "a film": ('ImageTexture url="color.png"', 'MovieTexture url="color.png"', "texture: found MovieTexture"),
    "empty depth": ('<depth><ImageTexture url="depth.png"/></depth>', "<depth/>", "depth: found nothing"),
    "no texture": ('<texture><ImageTexture url="color.png"/></texture>', "", "texture: found nothing"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD_NODES)
def test_bad_nodes(tmp_path, name):
    """The message has the number of the node: here the second is the bad one."""
    old, new, *words = BAD_NODES[name]
    good = NODE.format(fields=FIELDS)
    assert old in good
    path = put(tmp_path, TEXT.replace(good, good + good.replace(old, new)))
    check_refused(io.read_simple_texture, path, ": DepthImage 2: ", *words)


# Bad images


ESCAPES = ["../color.png", "images/../color.png", "/etc/passwd", "..", "images/../../color.png", "..\\color.png",
           "\\color.png", "C:\\color.png", "file:///etc/passwd", "http://127.0.0.1:9/a.png", "od:1", "od://1", "",
           " ", "''", "'a.png' 'b.png'", "&quot;../color.png&quot;", "data:image/png;base64,AAAA"]  # fmt: skip


@pytest.mark.parametrize("url", ESCAPES)
@pytest.mark.parametrize("which", ["color.png", "depth.png"])
def test_images_outside_the_folder_are_refused_by_their_name(tmp_path, url, which):
    """Even where they exist and are images, and where the detour ends inside."""
    folder = tmp_path / "set"
    (folder / "images").mkdir(parents=True)
    put(tmp_path)
    path = put(folder, TEXT.replace(f'"{which}"', f'"{url}"'))
    check_refused(io.read_simple_texture, path, "DepthImage 1: url: found", "in the folder of this one or below")


def test_an_absolute_path_is_refused_even_into_the_folder(tmp_path):
    path = put(tmp_path, TEXT.replace('"color.png"', f'"{tmp_path}/color.png"'))
    check_refused(io.read_simple_texture, path, "url: found", "in the folder")


@pytest.mark.skipif(os.name == "nt", reason="links need rights there")
def test_links_out_of_the_folder_are_refused(tmp_path):
    folder, other = tmp_path / "set", tmp_path / "other"
    folder.mkdir()
    other.mkdir()
    put(other)
    path = put(folder)
    (folder / "color.png").rename(folder / "real.png")
    (folder / "color.png").symlink_to("real.png")
    assert len(io.read_simple_texture(path)) == 1
    (folder / "color.png").unlink()
    (folder / "color.png").symlink_to(other / "color.png")
    check_refused(io.read_simple_texture, path, "url: found 'color.png'", "not a link out of it")
    (folder / "images").symlink_to(other)
    path.write_text(TEXT.replace('"color.png"', '"images/color.png"'))
    check_refused(io.read_simple_texture, path, "url: found 'images/color.png'", "not a link out of it")
    (folder / "color.png").unlink()
    (folder / "color.png").symlink_to("color.png")
    path.write_text(TEXT)
    check_refused(io.read_simple_texture, path)


@pytest.mark.skipif(os.name == "nt", reason="links need rights there")
def test_a_folder_that_is_itself_a_link(tmp_path):
    (tmp_path / "real").mkdir()
    put(tmp_path / "real")
    (tmp_path / "link").symlink_to("real")
    assert len(io.read_simple_texture(tmp_path / "link" / "set.xmt")) == 1


@pytest.mark.parametrize("which", ["color.png", "depth.png"])
def test_images_that_are_missing_or_cut_off(tmp_path, which):
    path = put(tmp_path)
    image = tmp_path / which
    whole = image.read_bytes()
    for size in (0, 4, 20, len(whole) // 2, len(whole) - 1):
        image.write_bytes(whole[:size])
        with pytest.raises((OSError, ValueError)) as caught:
            io.read_simple_texture(path)
        assert str(caught.value).startswith(f"{image}: ")
        assert "\n" not in str(caught.value)
    image.unlink()
    with pytest.raises(OSError, match=rf"{which}: cannot be read \(No such file"):
        io.read_simple_texture(path)


@pytest.mark.parametrize(
    ("colors", "codes", "bits", "words"),
    [
        (COLORS[:2], CODES, 8, "color.png: found 4 x 2 pixels, allowed: 4 x 3, the size of"),
        (COLORS, COLORS, 8, "depth.png: found [0, 7, 14] at row 0, column 0, allowed for depths: equal channels"),
        (COLORS, np.repeat(CODES[..., None], 2, axis=2), 8, "depth.png: found 2 channels, allowed for depths"),
        (COLORS, CODES % 2, 1, "depth.png: found 1 bits, allowed for depths: 8 or 16"),
    ],
)
def test_images_that_do_not_go_together(tmp_path, colors, codes, bits, words):
    path = put(tmp_path, colors=colors, codes=codes, bits=bits)
    with pytest.raises(ValueError, match="found") as caught:
        io.read_simple_texture(path)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_depths_in_jpeg_are_refused(tmp_path):
    """What was 0 is not 0 any more."""
    path = put(tmp_path, TEXT.replace("depth.png", "depth.jpg"))
    io.write_image(tmp_path / "depth.jpg", CODES / 255.0)
    with pytest.raises(ValueError, match=r"depth\.jpg: found a file that starts with .*allowed for depths: a PNG"):
        io.read_simple_texture(path)


# What cannot be written


def calibrated(**change):
    values = {"intrinsics": [[50, 0, 2], [0, 50, 1.5], [0, 0, 1]], "rotation": np.eye(3), "translation": (0, 0, 0),
              "near": 0.5, "far": 20.0, "width": 4, "height": 3}  # fmt: skip
    return Camera.calibrated(**{**values, **change})


def test_a_calibrated_camera_that_is_a_plain_one_is_written(tmp_path):
    camera = calibrated(translation=(1, 2, -3))
    (read,) = back(tmp_path, image_of(camera))
    np.testing.assert_allclose(read.camera.intrinsics, camera.intrinsics, rtol=1e-15)
    np.testing.assert_array_equal(read.camera.view_from_world, camera.view_from_world)


def almost(value):
    r = np.eye(3)
    r[0, 1] = value
    return r


CAMERAS = {
    "skew": ({"intrinsics": [[50, 0.001, 2], [0, 50, 1.5], [0, 0, 1]]}, "camera.intrinsics: found", "no skew"),
    "centre x": ({"intrinsics": [[50, 0, 2.001], [0, 50, 1.5], [0, 0, 1]]}, "camera.intrinsics: found", "[2.0, 1.5]"),
    "centre y": ({"intrinsics": [[50, 0, 2], [0, 50, 1.4], [0, 0, 1]]}, "camera.intrinsics: found", "the picture's centre"),
    "mirrored": ({"intrinsics": [[-50, 0, 2], [0, 50, 1.5], [0, 0, 1]]}, "camera.intrinsics: found", "no mirroring"),
    "measured": ({"rotation": almost(1e-4)}, "camera.view_from_world: found", "a rotation", "no measured one"),
}  # fmt: skip


@pytest.mark.parametrize("name", CAMERAS)
def test_cameras_that_afx_fields_cannot_express(tmp_path, name):
    change, *words = CAMERAS[name]
    images = [image_of(Camera.axis_angle(**PLACED)), image_of(calibrated(**change))]
    check_refused(lambda path: io.write_simple_texture(path, images), tmp_path / "set.xmt", "images[1]: ", *words)
    assert not list(tmp_path.iterdir())


def test_a_near_plane_behind_the_camera_is_not_written(tmp_path):
    camera = Camera.axis_angle(**{**PLACED, "orthographic": True, "near": -1.0})
    words = ("images[0]: camera.near: found -1.0", "AFX", ">= 0")
    check_refused(lambda path: io.write_simple_texture(path, [image_of(camera)]), tmp_path / "set.xmt", *words)


@pytest.mark.parametrize("beyond", [0.499, 20.001])
def test_depths_beyond_the_planes_are_not_written(tmp_path, beyond):
    depth = np.full((3, 4), 10.0)
    depth[1, 2] = beyond
    image = DepthImage(color=np.zeros((3, 4, 3)), depth=depth, camera=Camera.axis_angle(**PLACED))
    words = (f"images[0]: depth[1, 2]: found {beyond}", "0.5 to 20.0", "codes span")
    check_refused(lambda path: io.write_simple_texture(path, [image]), tmp_path / "set.xmt", *words)
    assert not list(tmp_path.iterdir())
    io.write_simple_texture(tmp_path / "set.xmt", [dataclasses.replace(image, mask=depth == 10.0)])


@pytest.mark.parametrize("images", [[], (), None, 7, [None]])
def test_only_depth_images_are_written(tmp_path, images):
    check_refused(
        lambda path: io.write_simple_texture(path, images), tmp_path / "set.xmt", "images: found", "DepthImages"
    )


def test_one_image_is_no_sequence(tmp_path):
    image = image_of(Camera.axis_angle(**PLACED))
    check_refused(lambda path: io.write_simple_texture(path, image), tmp_path / "set.xmt", "a sequence of DepthImages")


@pytest.mark.parametrize("name", ["a\tb.xmt", 'a".xmt', "a:b.xmt", "a\\b.xmt", "a\nb.xmt", "a\x01.xmt", "\ud800.xmt"])
def test_names_that_a_url_cannot_hold(tmp_path, name):
    image = image_of(Camera.axis_angle(**PLACED))
    with pytest.raises(ValueError, match="found the name"):
        io.write_simple_texture(tmp_path / name, [image])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["é'&<>.xmt", "a  b.xmt", "'a' 'b'.xmt", "set", ".xmt", "a.b.c"])
def test_names_that_need_care(tmp_path, name):
    image = image_of(Camera.axis_angle(**PLACED))
    io.write_simple_texture(tmp_path / name, [image])
    check_same_image(io.read_simple_texture(tmp_path / name)[0], image)


def test_a_place_that_cannot_be_written(tmp_path):
    images = [image_of(Camera.axis_angle(**PLACED))]
    check_refused(lambda path: io.write_simple_texture(path, images), tmp_path / "none" / "set.xmt", "does not exist")
    check_refused(lambda path: io.write_simple_texture(path, images), tmp_path, "is a folder")


def test_a_failed_write_leaves_no_file_that_names_images(tmp_path, monkeypatch):
    def fails(path, image, bits=8):
        raise OSError(f"{path}: cannot be written (disk full)")

    monkeypatch.setattr("ibr_ref.io.simple_texture.write_image", fails)
    with pytest.raises(OSError, match="disk full"):
        io.write_simple_texture(tmp_path / "set.xmt", [image_of(Camera.axis_angle(**PLACED))])
    assert not list(tmp_path.iterdir())


def test_measured_cameras_are_refused_and_not_bent(tmp_path):
    images = io.read_msr(shared("breakdancers"), cameras=(0,))
    words = ("images[0]: camera.intrinsics: found [[1884.19", "no skew")
    check_refused(lambda path: io.write_simple_texture(path, images), tmp_path / "set.xmt", *words)
