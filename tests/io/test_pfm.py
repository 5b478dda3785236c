"""PFM: what is written comes back, files made by hand, and headers that lie."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from ibr_ref import io
from ibr_ref.io import pfm
from tests.io.test_images import check_refused

shapes = array_shapes(min_dims=2, max_dims=2, max_side=9).flatmap(lambda s: st.sampled_from([s, (*s, 3)]))


@settings(max_examples=50, deadline=None)
@given(values=arrays(np.float32, shapes, elements=st.floats(width=32)))
def test_what_is_written_comes_back(values):
    np.testing.assert_array_equal(pfm.decode(pfm.encode(values)), values)


@pytest.mark.parametrize(("order", "scale"), [("<", "-1.0"), (">", "1.0"), ("<", "-0.003922"), (">", "+1e0")])
@pytest.mark.parametrize("between", [b"\n", b"\r\n", b" "])
def test_a_file_made_by_hand(tmp_path, order, scale, between):
    """2 x 3, the bottom row first."""
    head = between.join([b"Pf", b"2 3", scale.encode()]) + (b"\r\n" if between == b"\r\n" else b"\n")
    (tmp_path / "a.pfm").write_bytes(head + struct.pack(order + "6f", 5, np.inf, 3, 4, 1, -2))
    np.testing.assert_array_equal(io.read_values(tmp_path / "a.pfm"), [[1, -2], [3, 4], [5, np.inf]])


WHOLE = pfm.encode(np.zeros((3, 2)))


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (WHOLE[:-1], ["found 23 bytes", "24 needed", "2 x 3"]),
        (WHOLE + b"\0", ["found 25 bytes", "24 needed"]),
        (b"Pf\n60000 60000\n-1\n", ["60000 x 60000 pixels", "2^28"]),
        (b"Pf\n0 3\n-1\n", ["0 x 3 pixels"]),
        (b"Pf\n-2 3\n-1\n" + bytes(24), ["found a PFM header"]),
        (b"Pf\n2 3\nnan\n" + bytes(24), ["found a PFM header"]),
        (b"Pf", ["found a PFM header"]),
        (b"Pf\n" + b"9" * 5000, ["found a PFM header"]),
    ],
)
def test_headers_that_lie(tmp_path, data, words):
    (tmp_path / "a.pfm").write_bytes(data)
    check_refused(io.read_values, tmp_path / "a.pfm", *words)
