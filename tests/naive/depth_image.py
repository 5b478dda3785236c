"""splatting/method.md, "Stage normals" and "Stage atlas": unprojection, 8-bit normals, and the atlas."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .vectors import ZERO, Vec3, cross, dot, negate, normalize, sub, towards, vec4

Row4 = tuple[float, float, float, float]
Code = tuple[int, int, int]
Rect = tuple[int, int, int, int, int]
Points = list[list[Vec3 | None]]
Codes = list[list[Code]]

MAX_PAGES = 4
RELATIVE_JUMP = 0.05
OFF_MASK: Code = (0, 0, 0)


def rows4(matrix: Any) -> tuple[Row4, Row4, Row4, Row4]:
    """The four rows of a 4x4 matrix as plain floats."""
    return vec4(matrix[0]), vec4(matrix[1]), vec4(matrix[2]), vec4(matrix[3])


def affine(row: Row4, p: Vec3) -> float:
    """One row of a matrix applied to a point of w = 1, summed from left to right (conventions.md, "Triangles")."""
    return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]


def size_of(image: Any) -> tuple[int, int]:
    """(height, width) of a reference image."""
    height, width = image.depth.shape
    return int(height), int(width)


def is_valid(image: Any, row: int, column: int) -> bool:
    """Whether the pixel is a point (splatting/method.md, "Inputs"; no mask: all are)."""
    return image.mask is None or bool(image.mask[row, column])


def view_point(camera: Any, row: int, column: int, depth: float) -> Vec3:
    """The centre of a pixel in the reference camera's view space (splatting/method.md, "Stage vertex")."""
    intrinsics = camera.intrinsics
    f_x, skew, c_x = float(intrinsics[0][0]), float(intrinsics[0][1]), float(intrinsics[0][2])
    f_y, c_y = float(intrinsics[1][1]), float(intrinsics[1][2])
    u = column + 0.5
    v = row + 0.5
    y_n = (v - c_y) / f_y
    x_n = ((u - c_x) - skew * y_n) / f_x
    if camera.perspective:
        return x_n * depth, -y_n * depth, -depth
    return x_n, -y_n, -depth


def world_points(image: Any) -> Points:
    """World positions of all pixels, None off the mask (splatting/method.md, "Stage vertex")."""
    height, width = size_of(image)
    m = rows4(image.camera.world_from_view)
    points: Points = []
    for row in range(height):
        line: list[Vec3 | None] = []
        for column in range(width):
            if not is_valid(image, row, column):
                line.append(None)
                continue
            p = view_point(image.camera, row, column, float(image.depth[row, column]))
            line.append((affine(m[0], p), affine(m[1], p), affine(m[2], p)))
        points.append(line)
    return points


def depth_step(image: Any, row: int, column: int, other_row: int, other_column: int) -> float | None:
    """|depth difference| to a neighbour; None if it is off the image, off the mask or across a jump (stage normals)."""
    height, width = size_of(image)
    if not (0 <= other_row < height and 0 <= other_column < width):
        return None
    if not is_valid(image, other_row, other_column):
        return None
    depth = float(image.depth[row, column])
    step = abs(float(image.depth[other_row, other_column]) - depth)
    if step <= RELATIVE_JUMP * depth:
        return step
    return None


def chosen_side(after: float | None, before: float | None) -> int:
    """+1 for right or down, -1 for left or up, 0 for none: the nearer in depth, a tie: right, down (stage normals)."""
    if after is None:
        return 0 if before is None else -1
    if before is None or after <= before:
        return 1
    return -1


def surface_normal(image: Any, points: Points, row: int, column: int, p: Vec3) -> Vec3:
    """Cross product of the differences to the chosen neighbours; zero without a usable pair (stage normals)."""
    right = depth_step(image, row, column, row, column + 1)
    left = depth_step(image, row, column, row, column - 1)
    down = depth_step(image, row, column, row + 1, column)
    up = depth_step(image, row, column, row - 1, column)
    along_row = chosen_side(right, left)
    along_column = chosen_side(down, up)
    if along_row == 0 or along_column == 0:
        return ZERO
    horizontal = points[row][column + along_row]
    vertical = points[row + along_column][column]
    assert horizontal is not None
    assert vertical is not None
    return cross(sub(horizontal, p), sub(vertical, p))


def world_normal(image: Any, points: Points, row: int, column: int, p: Vec3) -> Vec3:
    """The unit normal of a valid pixel in world space, facing the reference camera (stage normals)."""
    to_camera = towards(vec4(image.camera.eye), p)
    n = surface_normal(image, points, row, column, p)
    if n[0] == 0.0 and n[1] == 0.0 and n[2] == 0.0:
        n = to_camera
    n = normalize(n)
    if dot(n, to_camera) < 0.0:
        n = negate(n)
    return n


def encode(n: Vec3) -> Code:
    """8-bit code of a normal, floor(127 n + 128.5) (stage normals)."""
    return (
        math.floor(127.0 * n[0] + 128.5),
        math.floor(127.0 * n[1] + 128.5),
        math.floor(127.0 * n[2] + 128.5),
    )


def decode(code: Code) -> Vec3:
    """The normal read back from its code, (k - 128)/127 normalized (stage normals)."""
    return normalize(((code[0] - 128) / 127.0, (code[1] - 128) / 127.0, (code[2] - 128) / 127.0))


def normal_codes(image: Any, points: Points) -> Codes:
    """8-bit normals of all pixels, (0, 0, 0) off the mask (stage normals)."""
    codes: Codes = []
    for row, line in enumerate(points):
        coded: list[Code] = []
        for column, p in enumerate(line):
            coded.append(OFF_MASK if p is None else encode(world_normal(image, points, row, column, p)))
        codes.append(coded)
    return codes


def pack(images: Any, limit: int) -> list[Rect]:
    """Shelves from left to right, top to bottom, in input order: (page, x, y, width, height) each (stage atlas)."""
    rects: list[Rect] = []
    page = x = y = shelf = 0
    for index, image in enumerate(images):
        height, width = size_of(image)
        if width > limit or height > limit:
            raise ValueError(f"images[{index}]: {width}x{height} does not fit max_atlas_size {limit}")
        if x + width > limit:
            y += shelf
            x = shelf = 0
        if y + height > limit:
            page += 1
            x = y = shelf = 0
        if page >= MAX_PAGES:
            raise ValueError(f"images[{index}]: does not fit {MAX_PAGES} pages of max_atlas_size {limit}")
        rects.append((page, x, y, width, height))
        x += width
        shelf = max(shelf, height)
    return rects


def page_sizes(rects: list[Rect]) -> list[tuple[int, int]]:
    """(height, width) of each page, cropped to what it holds (stage atlas)."""
    sizes: list[tuple[int, int]] = []
    for page, x, y, width, height in rects:
        if page == len(sizes):
            sizes.append((0, 0))
        rows, columns = sizes[page]
        sizes[page] = max(rows, y + height), max(columns, x + width)
    return sizes


def atlas(images: Any, codes: list[Codes], limit: int) -> dict[str, Any]:
    """The stages "atlas.*": rectangles and the three maps of each page (stage atlas)."""
    rects = pack(images, limit)
    sizes = page_sizes(rects)
    color = tuple(np.zeros((rows, columns, 3), dtype=np.float64) for rows, columns in sizes)
    depth = tuple(np.zeros((rows, columns), dtype=np.float64) for rows, columns in sizes)
    normal = tuple(np.zeros((rows, columns, 3), dtype=np.uint8) for rows, columns in sizes)
    for image, image_codes, (page, x, y, width, height) in zip(images, codes, rects, strict=True):
        for row in range(height):
            for column in range(width):
                if not is_valid(image, row, column):
                    continue
                depth[page][y + row, x + column] = float(image.depth[row, column])
                for channel in range(3):
                    color[page][y + row, x + column, channel] = float(image.color[row, column, channel])
                    normal[page][y + row, x + column, channel] = image_codes[row][column][channel]
    table = np.zeros((len(rects), 5), dtype=np.int32)
    for index, rect in enumerate(rects):
        for field in range(5):
            table[index, field] = rect[field]
    return {"atlas.rects": table, "atlas.color": color, "atlas.depth": depth, "atlas.normal": normal}
