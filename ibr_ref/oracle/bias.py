"""Small systematic errors: the difference of port and reference, regressed on the image's derivative by each parameter.

With D the derivative of the picture by a parameter p and r = port - reference, the change of p that fits best is
c = sum(D r) / sum(D D). A legal device makes errors too; what it may seem to have changed has a derived bound, no tuned one.
Each r_i lies within e_i, so |c| <= sum(|D| e) / sum(D D) always. Where the device rounds to the nearest everywhere (no
weights in steps, bytes to the nearest), errors have mean zero and do not know of each other; then by Hoeffding's inequality
|sum(D r)| <= sqrt(2 ln(2 / q) sum(D^2 e^2)) but for a probability of q, which is set to 10^-12. Bytes may also be truncated,
which moves all of them by half a step: the regression is made with either and the smaller coefficient counts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.judgement import Handed, Judgement, Parameter
from ibr_ref.oracle.referees import referee
from ibr_ref.oracle.verdict import Bias

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

IMPROBABLE = 1e-12
"""q above: one port in 10^12 is accused wrongly for each parameter."""
MOST_EXPLAINED = 0.5
"""Of a failed port's difference: below, a parameter's change is no explanation worth printing."""


def biases(case: Case, handed: Handed, image: Judgement, device: Device, *, wrong: bool) -> tuple[Bias, ...]:
    """Parameters whose change explains the difference, the best first.

    Of a port without a wrong element: only those whose change no legal device could seem to have made, which is a FAIL. Of
    a wrong one: those that explain more than half of the squared difference.
    """
    color = np.asarray(handed["color"])
    found = []
    for parameter in referee(case.method).parameters(case):
        bias = _bias(case, parameter, color, image, device)
        if bias is None:
            continue
        guilty = abs(bias.looks_like - bias.value) > bias.legal
        if guilty and (not wrong or bias.explained > MOST_EXPLAINED):
            found.append(bias)
    return tuple(sorted(found, key=lambda bias: -bias.explained)[:3])


def _bias(
    case: Case, parameter: Parameter, color: NDArray[np.generic], image: Judgement, device: Device
) -> Bias | None:
    """One parameter's regression; None where the picture does not depend on it."""
    middle = case.frame.color
    derivative, smooth = _derivative(parameter, middle)
    used = smooth & ~image.undecided
    d = derivative[used]
    power = float((d * d).sum())
    if power == 0.0:
        return None
    error = np.broadcast_to(_errors(image, color, device)[used][:, None], d.shape)
    legal = _legal(d, error, power, device) + abs(parameter.value) * 4.0 * UNIT
    best = None
    for residual in _residuals(color, middle, device):
        r = residual[used]
        change = float((d * r).sum()) / power
        total = float((r * r).sum())
        explained = change * change * power / total if total else 0.0
        if best is None or abs(change) < abs(best.looks_like - best.value):
            best = Bias(
                parameter=parameter.name,
                value=parameter.value,
                looks_like=parameter.value + change,
                explained=min(explained, 1.0),
                legal=legal,
            )
    return best


def _derivative(parameter: Parameter, middle: Floats) -> tuple[Floats, Bools]:
    """The picture's derivative, and (H, W) where it is one: where a decision turns, the picture jumps.

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
            return np.zeros_like(middle), np.zeros(middle.shape[:2], np.bool_)
        change, bend = whole - middle, whole + middle - 2.0 * half
        derivative = change / (sign * parameter.step)
    return derivative, (np.abs(bend) <= 0.1 * np.abs(change)).all(axis=-1)


def _moved(parameter: Parameter, step: float) -> Floats | None:
    """The picture with the parameter changed; None beyond its range."""
    try:
        return parameter.moved(parameter.value + step).draw(stages=False).color
    except ValueError:
        return None


def _errors(image: Judgement, color: NDArray[np.generic], device: Device) -> Floats:
    """(H, W) the most that a legal pixel lies from the reference."""
    step = device.byte / 255.0 if color.dtype == np.uint8 else 0.0
    return np.nan_to_num(image.width) / 2.0 + step


def _residuals(color: NDArray[np.generic], middle: Floats, device: Device) -> Iterator[Floats]:
    """Port minus reference, by each legal way of making bytes."""
    if color.dtype != np.uint8:
        yield color.astype(np.float64) - middle
        return
    yield color.astype(np.float64) / 255.0 - middle
    if device.byte > 0.6:  # the device may truncate: then a byte stands for what is half a step above, in the mean
        yield (color.astype(np.float64) + 0.5) / 255.0 - middle


def _legal(d: Floats, error: Floats, power: float, device: Device) -> float:
    """The largest change that a legal device seems to have made."""
    certain = float((np.abs(d) * error).sum()) / power
    if device.weight_step > 0.0:
        return certain  # truncated weights move all fetches the same way
    likely = math.sqrt(2.0 * math.log(2.0 / IMPROBABLE) * float((d * d * error * error).sum())) / power
    return min(certain, likely)
