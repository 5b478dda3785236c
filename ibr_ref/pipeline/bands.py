"""Bands of rows: what is drawn of a picture is shared out to the threads in them."""

from __future__ import annotations

import numpy as np

from ibr_ref.jit import device


@device
def stride_of(bands: int) -> int:
    """The bands turn * stride % bands, for all turns: each once, in an order that gives every thread an even sample."""
    stride = max(1, int(bands * 0.618))
    while np.gcd(stride, bands) != 1:
        stride += 1
    return stride
