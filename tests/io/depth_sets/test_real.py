"""A real stereo pair: Middlebury's Motorcycle (2014), as scikit-image ships it, four times smaller."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref import io, splatting
from tests.io.depth_sets import writers

CALIBRATION = """cam0=[994.978 0 311.193; 0 994.978 254.877; 0 0 1]
cam1=[994.978 0 342.279; 0 994.978 254.877; 0 0 1]
doffs=31.086
baseline=193.001
width=741
height=500
"""
"""As scikit-image's documentation of `stereo_motorcycle` has it."""


def test_the_right_photograph_from_the_left_one(tmp_path):
    data = pytest.importorskip("skimage.data", reason="the pair ships with scikit-image, which is not installed")
    left, right, disparity = data.stereo_motorcycle()
    for name, picture in (("im0", left), ("im1", right)):
        writers.png(tmp_path / f"{name}.png", picture)
    (tmp_path / "disp0.pfm").write_bytes(writers.pfm(np.where(np.isfinite(disparity), disparity, np.inf)))
    (tmp_path / "calib.txt").write_text(CALIBRATION)
    set_ = io.read_depth_set(tmp_path)
    _, camera = io.read_depth_cameras(tmp_path, far=1e5)
    frame = splatting.render(splatting.Scene(images=set_, camera=camera, light=None), splatting.Params(), stages=False)
    shown = frame.depth < 1
    assert shown.mean() > 0.8

    def decibels(columns):
        off = (np.roll(frame.color, columns, axis=1) - right / 255)[np.roll(shown, columns, axis=1)]
        return -10 * np.log10(np.mean(off**2))

    assert decibels(0) > 26
    assert max(decibels(-1), decibels(1)) < decibels(0) - 4
