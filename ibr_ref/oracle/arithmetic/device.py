"""The arithmetic of a graphics device, operation by operation: what a `Policy` does of what a device may do.

Numbers are float64 arrays that hold float32 values: each operation is computed in float64 and rounded once, which for sums,
products, quotients and square roots of float32 numbers is the correctly rounded float32 result (Figueroa 1995: double
rounding is harmless with 2 p + 2 bits).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.array_types import Floats
from ibr_ref.oracle.arithmetic.one_way import OneWay


@dataclass(frozen=True, kw_only=True)
class Policy:
    """One way to be a correct device."""

    float_bits: int = 32
    """32, or 64 for a device that rounds like the reference."""
    backwards: bool = False
    """Sums are added from the right."""
    fused: bool = False
    """Products are not rounded before they are added."""
    reciprocal: bool = False
    """A quotient is the product with the rounded reciprocal; a square root is the reciprocal of an inverse root."""
    truncated: bool = False
    """Results are rounded towards zero, as Direct3D grants: each is less than one unit in the last place off."""
    loose: int = 0
    """Quotients and square roots move by up to so many units in the last place more than they are rounded, as Vulkan and
    WGSL grant two; as `jitter` moves them."""
    intrinsic_power: bool = False
    """A power is exp2(e log2 x), as pow() is; with `loose` the logarithm is off as far as Vulkan grants."""
    jitter: int = 0
    """Every result moves by up to so many units in the last place, at random, equal ones alike: a device that is given the
    same numbers twice gives the same result, and a corner that two triangles share is one point."""
    seed: int = 0
    """Of the jitter."""
    weight_bits: int | None = None
    """Fractional bits of bilinear weights; None: not rounded."""
    weight_rounding: str = "nearest"
    """nearest | down."""
    filtered_bytes: bool = False
    """A bilinear fetch from texels that are bytes gives bytes: each of its lerps is rounded to one."""
    subpixel_bits: int = 8
    """Fractional bits of window positions."""
    subpixel_rounding: str = "even"
    """even | up (ties) | down (truncated)."""
    snapped_varyings: bool = True
    """Varyings are interpolated over the snapped triangle, as in the reference; else over the unsnapped one."""
    depth_bits: int | None = None
    """24: depths are rounded to multiples of 1/(2^24 - 1); None: floats."""
    color_bits: int | None = None
    """8: colours are rounded to bytes."""


def _scattered(array: Floats, seed: int) -> NDArray[np.uint64]:
    """The same number for the same bits, and else any: splitmix64 (Steele, Lea & Flood 2014)."""
    bits = np.array(array, np.float64, ndmin=1).view(np.uint64) + np.uint64(seed * 0x9E3779B97F4A7C15 % 2**64)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        bits = (bits ^ (bits >> np.uint64(shift))) * np.uint64(factor)
    return np.asarray(bits ^ (bits >> np.uint64(31)), np.uint64).reshape(np.shape(array))


class Arithmetic(OneWay):
    """Operations as a policy makes them. Arguments are numbers or arrays that broadcast."""

    bounded = False

    @property
    def backwards(self) -> bool:
        """Whether sums are added from the right."""
        return self.policy.backwards

    minus_one = False

    def __init__(self, policy: Policy) -> None:
        self.policy = policy

    def number(self, value: ArrayLike) -> Floats:
        """A value as it is uploaded: rounded to the nearest float, never jittered."""
        array = np.asarray(value, np.float64)
        return array if self.policy.float_bits == 64 else array.astype(np.float32).astype(np.float64)

    def matrix(self, value: ArrayLike) -> Floats:
        """A matrix as it is uploaded."""
        return self.number(value)

    def texels(self, value: ArrayLike) -> Floats:
        """A texture as it is uploaded, to be fetched texel by texel."""
        return self.number(value)

    # --- What only bounds need to be told -----------------------------------------------------------------------------

    def told(self, step: str, x: Any) -> Any:
        """What a trace tells of: a number, a vector, a comparison."""
        return x

    def named(self, name: str, x: Any) -> Any:
        """What is used again."""
        return x

    def either(self, first: Any, *others: Callable[[], Any]) -> Any:
        """A formula, and its other legal forms beside it."""
        return first

    def widened(self, x: Any, quotients: float = 0.0, operations: float = 0.0) -> Any:
        """What another form rounds so many times."""
        return x

    def one_place(self) -> AbstractContextManager[None]:
        """Fetches at the same coordinate are so at the same texel position."""
        return nullcontext()

    def beyond(self, x: Any, least: float, up: Any) -> Any:
        """What is decided to be >= `least` (`up`), or <= -`least`."""
        return x

    def between(self, x: Any, low: Any, high: Any) -> Any:
        """What is known to lie between two ends."""
        return x

    def settled(self, x: Any, *others: Any) -> Any:
        """What a loop carries on."""
        return x

    def pick(self, condition: Any, first: Callable[[], Any], other: Callable[[], Any]) -> Any:
        """One of two, by a condition of the whole case."""
        return first() if condition else other()

    def in_lanes(self, x: Any, like: Any) -> Any:
        """A number of the whole case for each row of `like`."""
        return np.broadcast_to(x, np.shape(like))

    def surely(self, truth: Any) -> bool:
        """Whether something holds for all rows."""
        return bool(np.all(truth))

    def border(self, x: Any, sides: float = 1.0) -> Any:
        """What may be off by the borders that devices give to splats, as many."""
        return x

    def alike(self, a: Any, b: Any) -> Any:
        """Which of two uploaded numbers are the same."""
        return a == b

    def missing(self, x: Any) -> Any:
        """Which are no numbers."""
        return np.isnan(x)

    def of_bytes(self, x: Any) -> Any:
        """What a filter makes of texels that are bytes: how far that may be off is known of all of it."""
        return x

    def rising(self, f: Callable[[Any], Any], x: Any) -> Any:
        """A function that nowhere falls."""
        return f(x)

    # --- Rows ---------------------------------------------------------------------------------------------------------

    def rows(self, x: Any, at: Any) -> Any:
        """Rows of a number, or of each component of a vector: what each lane has."""
        return [each[at] for each in x] if isinstance(x, list) else x[at]

    def blank(self, like: Any, shape: tuple[int, ...]) -> Any:
        """Zeros of the same kind."""
        return np.zeros(shape, like.dtype)

    def replaced(self, x: Any, where: Any, by: Any) -> Any:
        """With other rows at some places."""
        result = np.array(x)
        result[where] = by
        return result

    def spread(self, x: Any, where: Any, count: int, nothing: float) -> Any:
        """Rows at some of `count` places, `nothing` elsewhere."""
        result = np.full(count, nothing, np.asarray(x).dtype)
        result[where] = x
        return result

    # --- Operations ---------------------------------------------------------------------------------------------------

    def whole(self, x: Any) -> Floats:
        """floor(x)."""
        return np.asarray(np.floor(x), np.float64)

    def least(self, a: Any, b: Any) -> Floats:
        """The smaller of two."""
        return np.asarray(np.minimum(a, b), np.float64)

    def greatest(self, a: Any, b: Any) -> Floats:
        """The larger of two."""
        return np.asarray(np.maximum(a, b), np.float64)

    def first_least(self, numbers: Sequence[ArrayLike]) -> NDArray[np.int64]:
        """Which is the least, of equal ones the first."""
        return np.asarray(np.argmin(np.stack(numbers), axis=0), np.int64)

    def round(self, value: ArrayLike) -> Floats:
        """A result of one operation."""
        array = self.number(value)
        if self.policy.truncated:
            toward_zero = np.nextafter(array.astype(np.float32), np.float32(0.0)).astype(np.float64)
            array = np.where(np.abs(array) > np.abs(value), toward_zero, array)
        return self.moved(array, self.policy.jitter)

    def moved(self, array: Floats, most: int) -> Floats:
        """Each float32 by up to `most` units in the last place; how far follows from its bits (see `Policy.jitter`)."""
        if not most or self.policy.float_bits == 64:
            return array
        unit = np.spacing(np.abs(array).astype(np.float32)).astype(np.float64)
        steps = (_scattered(array, self.policy.seed) % np.uint64(2 * most + 1)).astype(np.int64) - most
        moves = np.isfinite(array) & (array != 0.0)  # a step from 0 is a denormal number, which devices flush to 0
        return self.number(np.where(moves, array + steps * unit, array))

    def add(self, a: ArrayLike, b: ArrayLike) -> Floats:
        """A + b."""
        return self.round(np.add(a, b))

    def subtract(self, a: ArrayLike, b: ArrayLike) -> Floats:
        """A - b."""
        return self.round(np.subtract(a, b))

    def multiply(self, a: ArrayLike, b: ArrayLike) -> Floats:
        """A b."""
        return self.round(np.multiply(a, b))

    def divide(self, a: ArrayLike, b: ArrayLike) -> Floats:
        """A / b."""
        with np.errstate(divide="ignore", invalid="ignore"):
            if self.policy.reciprocal:
                return self.multiply(a, self.round(np.divide(1.0, b)))
            found = self.round(np.divide(a, b))
        # By a constant power of two it is exact: shaders multiply by those.
        return found if np.ndim(b) == 0 and np.frexp(b)[0] == 0.5 else self.moved(found, self.policy.loose)

    def root(self, a: ArrayLike) -> Floats:
        """The square root."""
        with np.errstate(divide="ignore", invalid="ignore"):
            if self.policy.reciprocal:
                inverse = self.round(1.0 / np.sqrt(a))
                return np.where(np.asarray(a) == 0.0, 0.0, self.round(1.0 / inverse))
            return self.moved(self.round(np.sqrt(a)), self.policy.loose)

    def sum(self, terms: Sequence[ArrayLike]) -> Floats:
        """All terms, from the left, or from the right."""
        ordered = [*terms][::-1] if self.policy.backwards else [*terms]
        return np.asarray(reduce(self.add, ordered), np.float64)

    def dot(self, a: Sequence[ArrayLike], b: Sequence[ArrayLike]) -> Floats:
        """Sum of the products of two sequences."""
        pairs = list(zip(a, b, strict=True))
        if self.policy.backwards:
            pairs.reverse()
        result = self.multiply(*pairs[0])
        for x, y in pairs[1:]:
            if self.policy.fused:
                result = self.round(np.multiply(x, y) + result)
            else:
                result = self.add(result, self.multiply(x, y))
        return result

    def lerp(self, a: ArrayLike, b: ArrayLike, f: ArrayLike) -> Floats:
        """A (1 - f) + b f."""
        return self.dot([a, b], [self.subtract(1.0, f), f])

    def unit(self, a: Sequence[ArrayLike]) -> list[Floats]:
        """A vector divided by its length; the zero vector stays."""
        length = self.root(self.dot(a, a))
        safe = np.where(length > 0.0, length, 1.0)
        return [self.divide(x, safe) for x in a]

    def power(self, base: ArrayLike, exponent: int) -> Floats:
        """A whole power by repeated squaring, lowest bit first, or as pow() has it."""
        if self.policy.intrinsic_power:
            with np.errstate(divide="ignore", invalid="ignore"):
                logarithm = np.log2(np.asarray(base, np.float64))
            if self.policy.loose:
                logarithm = logarithm + (_scattered(logarithm, self.policy.seed) % np.uint64(3) - 1.0) * 2.0**-21.5
            return self.round(np.exp2(self.multiply(exponent, self.round(logarithm))))
        result, base = np.ones_like(np.asarray(base, np.float64)), np.asarray(base, np.float64)
        while exponent:
            if exponent % 2:
                result = self.multiply(result, base)
            base = self.multiply(base, base)
            exponent //= 2
        return result

    def exponential(self, x: ArrayLike) -> Floats:
        """e^x, of a number <= 0."""
        return self.moved(self.round(np.exp(x)), self.policy.loose)

    def totals(self, terms: Floats, of: NDArray[np.int64], count: int) -> Floats:
        """(count,) sums of the terms (n,) that each row has, one after another; of (n,): whose they are, growing."""
        many = np.bincount(of, minlength=count)
        starts, result = np.cumsum(many) - many, np.zeros(count)
        for turn in range(many.max(initial=0)):
            rows = np.flatnonzero(many > turn)
            at = starts[rows] + (many[rows] - 1 - turn if self.policy.backwards else turn)
            result[rows] = self.add(result[rows], terms[at]) if turn else terms[at]
        return result

    def mean(self, weights: Floats, x: Floats, of: NDArray[np.int64], count: int) -> Floats:
        """(count,) weighted averages of what each row has; 0 where it has nothing."""
        whole = self.totals(weights, of, count)
        return self.divide(self.totals(self.multiply(weights, x), of, count), np.where(whole == 0.0, 1.0, whole))

    def weight(self, fraction: Floats) -> Floats:
        """A bilinear weight as the texture unit has it."""
        if self.policy.weight_bits is None:
            return fraction
        steps = fraction * 2.0**self.policy.weight_bits
        return (np.floor(steps) if self.policy.weight_rounding == "down" else np.rint(steps)) / (
            2.0**self.policy.weight_bits
        )

    def filtered(self, mixed: Floats, texels: Sequence[Floats]) -> Floats:
        """A lerp of texels as the texture unit has it."""
        if not self.policy.filtered_bytes or any((np.abs(255.0 * t - np.rint(255.0 * t)) > 1e-4).any() for t in texels):
            return mixed
        return self.number(np.rint(255.0 * mixed) / 255.0)

    def snap(self, window: ArrayLike) -> Floats:
        """A window position on the raster of subpixels."""
        steps = np.asarray(window, np.float64) * 2.0**self.policy.subpixel_bits
        if self.policy.subpixel_rounding == "even":
            steps = np.rint(steps)
        else:
            steps = np.floor(steps + (0.5 if self.policy.subpixel_rounding == "up" else 0.0))
        return np.asarray(steps / 2.0**self.policy.subpixel_bits, np.float64)

    def depth(self, depth: ArrayLike) -> Floats:
        """A window depth as the depth buffer holds it."""
        if self.policy.depth_bits is None:
            return self.number(depth)
        most = 2.0**self.policy.depth_bits - 1.0
        return np.asarray(np.floor(np.clip(depth, 0.0, 1.0) * most + 0.5) / most, np.float64)

    def blended_byte(self, value: ArrayLike) -> Floats:
        """The sum that blending makes, as a frame buffer of bytes holds it: floor(255 c + 0.5) / 255, saturated."""
        return self.divide(np.floor(self.add(self.multiply(np.minimum(value, 1.0), 255.0), 0.5)), 255.0)

    def flat_depth(self, depth: ArrayLike) -> Floats:
        """The depth of a primitive that has one, as the depth buffer holds it."""
        return self.depth(depth)

    def color(self, color: ArrayLike) -> Floats:
        """A colour as the frame buffer holds it: bytes are given back as k / 255."""
        if self.policy.color_bits is None:
            return self.number(color)
        return np.asarray(np.floor(255.0 * np.clip(color, 0.0, 1.0) + 0.5) / 255.0, np.float64)
