"""The conventions of all cases, in words: what a port needs to know to agree number by number."""

from __future__ import annotations

CONVENTIONS = {
    "images": "arrays are (rows, columns[, channels]), row 0 on top; pixel (x, y) is column x, row y, its centre "
    "(x + 0.5, y + 0.5); window y grows downwards",
    "bytes": "colours are linear, no sRGB transfer; in: k / 255; out: floor(255 c + 0.5) of c clamped to [0, 1]",
    "textures": "texel (column j, row i) of W x H has its centre at ((j + 0.5) / W, (i + 0.5) / H); row 0 is v = 0",
    "bilinear": "x = u W - 0.5, y = v H - 0.5, x0 = floor(x), f = x - x0; texels by the wrap mode (clamp or repeat); "
    "lerp(lerp(t00, t10, fx), lerp(t01, t11, fx), fy), lerp(a, b, f) = a (1 - f) + b f",
    "nearest": "texel floor(u W), floor(v H), then the wrap mode",
    "spaces": "world and view are right-handed; the camera looks down -z of view space, +y up, +x right",
    "ndc": "x and y in [-1, 1], y up; z in [0, 1], 0 at the near plane; matrices named _gl have z in [-1, 1] and give "
    "the same window depth",
    "window": "x = (x_ndc + 1) / 2 width, y = (1 - y_ndc) / 2 height, depth = z_ndc",
    "matrices": "row by row, for column vectors, named destination_from_source; applied one after the other, each row "
    "summed from left to right",
    "triangles": "window x and y rounded to 1/256 pixel, ties to even; integer edge functions, top-left rule; both "
    "orientations are drawn unless a pass says otherwise",
    "varyings": "perspective-correct, weights from the snapped corners, at the pixel's centre; depth linear in the window",
    "clipping": "near, then far (0 <= z <= w), before the division; the polygon is fanned from its first vertex",
    "points": "a square splat of width w at c covers the pixels whose centres lie in [c - w/2, c + w/2) on both axes, "
    "c rounded to 1/256 pixel",
    "depth_test": "LESS, in submission order; depth is cleared to 1, colour to the background",
    "gl_ports": "negate clip y instead of flipping the rows on read-back: a flip turns the half-open rules upside down",
    "files": ".npy is little-endian and in C order; hand in arrays under the names of `expected`: any subset, or the "
    "final image alone as color.png or color.npy; floats as float32 or float64, integers as integers, flags as "
    "booleans or 0 and 1",
}
