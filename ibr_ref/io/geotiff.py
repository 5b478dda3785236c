"""What the tags of GeoTIFF (OGC 19-008r4) and of GDAL say of a TIFF image's samples."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from ibr_ref.scene.checks import one_line

PIXEL_SCALE, TRANSFORMATION, KEYS, GDAL_METADATA, GDAL_NODATA = 33550, 34264, 34735, 42112, 42113
_MODEL_TYPE, _LINEAR_UNITS, _VERTICAL_UNITS = 1024, 3076, 4099
_PROJECTED = 1

_ITEM = re.compile(r"<Item\b([^>]*)>([^<]*)</Item>")
_ROLE = re.compile(r'\brole="(scale|offset)"')
_SAMPLE = re.compile(r'\bsample="(\d+)"')


def nodata(tags: Mapping[int, Any]) -> float | None:
    """The stored number that says that there is nothing (GDAL_NODATA); raises ValueError where it is no number."""
    text = tags.get(GDAL_NODATA)
    return None if text is None else _number(str(text).strip(" \0\n"), "nodata value", nan=True)


def scale_and_offset(tags: Mapping[int, Any]) -> tuple[float, float]:
    """What makes heights of stored numbers, of the first sample (GDAL_METADATA); 1 and 0 where nothing is said.

    Raises ValueError for what is no number, and a scale of 0.
    """
    found = {"scale": 1.0, "offset": 0.0}
    for attributes, text in _ITEM.findall(str(tags.get(GDAL_METADATA, ""))):
        role, sample = _ROLE.search(attributes), _SAMPLE.search(attributes)
        if role is not None and (sample is None or sample[1] == "0"):
            found[role[1]] = _number(text.strip(), role[1])
    if found["scale"] == 0.0:
        raise ValueError("found the scale 0 in the tags of a GeoTIFF image, allowed: other numbers")
    return found["scale"], found["offset"]


def texel_size(tags: Mapping[int, Any]) -> tuple[float, float] | None:
    """Width and height of a pixel in the units of the heights.

    None where the image lies in no projection (degrees are no lengths), is turned in it, or has its heights in other units
    than its lengths.
    """
    keys = _keys(tags)
    if keys.get(_MODEL_TYPE) != _PROJECTED:
        return None
    if keys.get(_VERTICAL_UNITS, keys.get(_LINEAR_UNITS)) != keys.get(_LINEAR_UNITS):
        return None
    scale, matrix = _floats(tags.get(PIXEL_SCALE)), _floats(tags.get(TRANSFORMATION))
    if len(scale) == 3:
        size = abs(scale[0]), abs(scale[1])
    elif len(matrix) == 16 and matrix[1] == matrix[4] == 0.0:
        size = abs(matrix[0]), abs(matrix[5])
    else:
        return None
    return size if all(math.isfinite(side) and side > 0.0 for side in size) else None


def _keys(tags: Mapping[int, Any]) -> dict[int, int]:
    """Those of the directory whose values are in it."""
    words = tags.get(KEYS)
    words = words if isinstance(words, tuple) else ()
    rows = [words[i : i + 4] for i in range(4, len(words) - 3, 4)]
    return {int(key): int(value) for key, place, _, value in rows if place == 0}


def _floats(value: Any) -> tuple[float, ...]:
    return tuple(map(float, value)) if isinstance(value, tuple) else ()


def _number(text: str, what: str, nan: bool = False) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan if nan and text.lower() == "nan" else math.inf
    if math.isinf(value) or (math.isnan(value) and not nan):
        raise ValueError(f"found the {what} {one_line(repr(text), 80)} in the tags of a GeoTIFF image, a number needed")
    return value
