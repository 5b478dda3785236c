"""Small systematic errors: the difference of port and reference, regressed on the image's derivative by each parameter.

With D the derivative of the picture by a parameter p and r = port - reference, the change of p that fits best is
c = sum(D r) / sum(D D). A legal device makes errors too; what it may seem to have changed has a derived bound: each r_i lies
within e_i, so |c| <= sum(|D| e) / sum(D D). No statistics: legal errors are not independent. A constant that is rounded once
moves every pixel the same way, and all pixels of one colour are rounded alike.

Of floats e is half the width of the accepted set, so a picture whose pixels are all legal has no guilty coefficient. Bytes
are where small errors hide: most APIs allow either neighbour, pixel by pixel, but a device has one way to make bytes. So r
is the difference from the byte that the nearest, or truncation, makes of the reference, and e one step only where the
accepted set reaches over the border between two bytes. A coefficient that is too large by every way is a FAIL.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.findings import Bias
from ibr_ref.oracle.judgement import Handed, Judgement, Parameter
from ibr_ref.oracle.referees import referee

MOST_EXPLAINED = 0.5
"""Of a failed port's squared difference: a change that explains less than half is no explanation worth printing."""
PRODUCT = 255.0 * UNIT
"""Rounding of 255 c in float32, the number that becomes a byte."""
_MOST_KEPT = 2**26
"""Bytes of a case's derivatives: those of a larger picture are made again for each submission."""


class _Derivative(NamedTuple):
    """A picture's, by one parameter."""

    value: Floats
    """(H, W, 3)."""
    smooth: Bools
    """(H, W) where it is one: where a decision turns, the picture jumps."""


def biases(case: Case, handed: Handed, image: Judgement, device: Device, *, wrong: bool) -> tuple[Bias, ...]:
    """Parameters whose change explains the difference, the best first.

    Of a port without a wrong element: only those whose change no legal device could seem to have made, which is a FAIL. Of
    a wrong one: those that explain more than half of the squared difference.
    """
    color = np.asarray(handed["color"])
    if not wrong and color.dtype != np.uint8:
        return ()
    found = []
    for parameter in referee(case.method).parameters(case):
        bias = _bias(case, parameter, color, image, device)
        if bias is None:
            continue
        guilty = _excess(bias) > 0.0
        if guilty and (not wrong or bias.explained > MOST_EXPLAINED):
            found.append(bias)
    return tuple(sorted(found, key=lambda bias: -bias.explained)[:3])


def _bias(
    case: Case, parameter: Parameter, color: NDArray[np.generic], image: Judgement, device: Device
) -> Bias | None:
    """One parameter's regression; None where the picture does not depend on it."""
    middle = case.frame.color
    derivative = _derivative(case, parameter)
    used = derivative.smooth & ~image.undecided
    d = derivative.value[used]
    power = float((d * d).sum())
    if power == 0.0:
        return None
    best = None
    for residual, error in _residuals(color, middle, image, device):
        r, e = residual[used], np.broadcast_to(error, residual.shape)[used]
        change = float((d * r).sum()) / power
        total = float((r * r).sum())
        bias = Bias(
            parameter=parameter.name,
            value=parameter.value,
            looks_like=parameter.value + change,
            explained=min(change * change * power / total, 1.0) if total else 0.0,
            legal=float((np.abs(d) * e).sum()) / power + abs(parameter.value) * 4.0 * UNIT,
        )
        if best is None or _excess(bias) < _excess(best):
            best = bias
    return best


def _excess(bias: Bias) -> float:
    """How far beyond what is legal."""
    return abs(bias.looks_like - bias.value) - bias.legal


def _derivative(case: Case, parameter: Parameter) -> _Derivative:
    """Made once a parameter: it follows from the case alone, and is two pictures."""
    known: dict[str, _Derivative] = case.kept.setdefault("bias", {})
    if parameter.name in known:
        return known[parameter.name]
    found = _quotient(parameter, case.frame.color)
    if sum(array.nbytes for one in (found, *known.values()) for array in one) <= _MOST_KEPT:
        known[parameter.name] = found
    return found


def _quotient(parameter: Parameter, middle: Floats) -> _Derivative:
    """The derivative as a difference quotient.

    At the end of a parameter's range the quotient is one-sided, and compared with that of half the step.
    """
    up, down = (_moved(parameter, sign * parameter.step) for sign in (1.0, -1.0))
    if up is not None and down is not None:
        change, bend = up - down, up + down - 2.0 * middle
        derivative = change / (2.0 * parameter.step)
    else:
        sign = -1.0 if up is None else 1.0
        whole, half = _moved(parameter, sign * parameter.step), _moved(parameter, sign * 0.5 * parameter.step)
        if whole is None or half is None:
            return _Derivative(np.zeros_like(middle), np.zeros(middle.shape[:2], np.bool_))
        change, bend = whole - middle, whole + middle - 2.0 * half
        derivative = change / (sign * parameter.step)
    smooth = np.abs(bend) <= 0.1 * np.abs(change)  # a picture that jumps bends by as much as it changes
    return _Derivative(derivative, np.asarray(smooth.all(axis=-1), np.bool_))


def _moved(parameter: Parameter, step: float) -> Floats | None:
    """The picture with the parameter changed; None beyond its range."""
    try:
        return parameter.moved(parameter.value + step).draw(stages=False).color
    except ValueError:
        return None


def _residuals(
    color: NDArray[np.generic], middle: Floats, image: Judgement, device: Device
) -> Iterator[tuple[Floats, Floats]]:
    """(H, W, 3) port minus reference and the most that a legal device's may be, by each way of making bytes."""
    reach = np.nan_to_num(image.width)[..., None] / 2.0
    if color.dtype != np.uint8:
        yield color.astype(np.float64) - middle, reach
        return
    nearest_only = device.byte < 1.0
    slack = PRODUCT + (device.byte - 0.5 if nearest_only else 0.0)
    for offset in (0.5,) if nearest_only else (0.5, 0.0):
        steps = 255.0 * np.clip(middle, 0.0, 1.0) + offset
        low, high = (np.floor(steps + side * (255.0 * reach + slack)) for side in (-1.0, 1.0))
        yield (color.astype(np.float64) - np.floor(steps)) / 255.0, (high - low) / 255.0
