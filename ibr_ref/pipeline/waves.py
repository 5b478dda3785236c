"""Waves: LANES fragments that take every step together. What loops over their lanes need beside plain arithmetic.

Such a loop becomes SIMD only where LLVM sees that its arrays do not overlap. Of arrays on the heap it does not; so those of
the lanes are made on the stack of the kernel that uses them, and what moves whole waves from and to the heap, or folds
them, is emitted here as vector instructions (loops and the heap for all: twice the time, measured).

Each of these is a Python function first: what it means, what runs without compiled kernels, and what is compiled where
bounds are to be checked. An `array` is (F,), with whole waves.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

from ibr_ref.array_types import Floats, IndexLanes, Indices, Lanes
from ibr_ref.jit import LANES, Function, config, device

__all__ = [
    "gather",
    "index_lanes",
    "lanes",
    "largest",
    "load",
    "load_indices",
    "smallest",
    "store",
    "store_indices",
]

_PLAIN = bool(config.DISABLE_JIT or config.BOUNDSCHECK)


def emitted(meant: Function, instructions: Any) -> Function:
    """The instructions, which are called as the Python function is that says what they mean; or that one, where it runs."""
    return meant if _PLAIN else instructions


# --- The lanes' arrays -----------------------------------------------------------------------------------------------


def _on_stack(dtype: type[np.generic]) -> Any:
    """A function that makes an array of LANES elements on the stack of the kernel that calls it."""
    if config.DISABLE_JIT:
        return lambda: np.empty(LANES, dtype)

    @intrinsic
    def make(typing: Any) -> Any:
        item = numba.from_dtype(np.dtype(dtype))

        def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            element = context.get_data_type(item)
            with builder.goto_entry_block():
                memory = builder.alloca(ir.ArrayType(element, LANES))
            memory.align = 64
            length, stride = (context.get_constant(types.intp, n) for n in (LANES, np.dtype(dtype).itemsize))
            array = make_array(signature.return_type)(context, builder)
            data = builder.bitcast(memory, element.as_pointer())
            populate_array(array, data=data, shape=[length], strides=[stride], itemsize=stride, meminfo=None)
            return array._getvalue()

        return types.Array(item, 1, "C")(), emit

    return make


lanes: Callable[[], Lanes] = _on_stack(np.float64)
"""lanes(): an array for the lanes of a wave, not initialized. Only in kernels; it dies with the call of its kernel."""

index_lanes: Callable[[], IndexLanes] = _on_stack(np.int32)
"""index_lanes(): the same for indices, int32."""


# --- What they mean --------------------------------------------------------------------------------------------------


@device
def _load(array: Floats, first: int, wave: Lanes) -> None:
    for lane in range(LANES):
        wave[lane] = array[first + lane]


@device
def _load_indices(array: Indices, first: int, wave: Lanes) -> None:
    for lane in range(LANES):
        wave[lane] = np.float64(array[first + lane])


@device
def _store(wave: Lanes, array: Floats, first: int) -> None:
    for lane in range(LANES):
        array[first + lane] = wave[lane]


@device
def _store_indices(wave: Lanes, array: Indices, first: int) -> None:
    for lane in range(LANES):
        array[first + lane] = np.int32(wave[lane])


@device
def _gather(texels: Floats, indices: IndexLanes, wave: Lanes) -> None:
    for lane in range(LANES):
        wave[lane] = texels[indices[lane]]


@device
def _smallest(wave: Lanes) -> float:
    folded, half = lanes(), LANES
    _load(wave, 0, folded)
    while half > 1:
        half //= 2
        for lane in range(half):
            folded[lane] = folded[lane] if folded[lane] < folded[lane + half] else folded[lane + half]
    return folded[0]


@device
def _largest(wave: Lanes) -> float:
    folded, half = lanes(), LANES
    _load(wave, 0, folded)
    while half > 1:
        half //= 2
        for lane in range(half):
            folded[lane] = folded[lane] if folded[lane] > folded[lane + half] else folded[lane + half]
    return folded[0]


# --- The same as vector instructions ---------------------------------------------------------------------------------


def _vector(context: Any, builder: Any, array_type: Any, array: Any, first: Any = None) -> tuple[Any, int]:
    """A pointer to LANES elements of an array as one vector, and the alignment of its elements."""
    element = context.get_data_type(array_type.dtype)
    data = make_array(array_type)(context, builder, array).data
    data = data if first is None else builder.gep(data, [first])
    pointer = builder.bitcast(data, ir.VectorType(element, LANES).as_pointer())
    return pointer, context.get_abi_sizeof(element)


@intrinsic
def _load_vector(typing: Any, array: Any, first: Any, wave: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source, align = _vector(context, builder, signature.args[0], *arguments[:2])
        target, _ = _vector(context, builder, signature.args[2], arguments[2])
        builder.store(builder.load(source, align=align), target, align=64)
        return context.get_dummy_value()

    return types.void(array, types.intp, wave), emit


@intrinsic
def _load_index_vector(typing: Any, array: Any, first: Any, wave: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source, align = _vector(context, builder, signature.args[0], *arguments[:2])
        target, _ = _vector(context, builder, signature.args[2], arguments[2])
        floats = builder.sitofp(builder.load(source, align=align), ir.VectorType(ir.DoubleType(), LANES))
        builder.store(floats, target, align=64)
        return context.get_dummy_value()

    return types.void(array, types.intp, wave), emit


@intrinsic
def _store_vector(typing: Any, wave: Any, array: Any, first: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source, _ = _vector(context, builder, signature.args[0], arguments[0])
        target, align = _vector(context, builder, signature.args[1], *arguments[1:])
        builder.store(builder.load(source, align=64), target, align=align)
        return context.get_dummy_value()

    return types.void(wave, array, types.intp), emit


@intrinsic
def _store_index_vector(typing: Any, wave: Any, array: Any, first: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source, _ = _vector(context, builder, signature.args[0], arguments[0])
        target, align = _vector(context, builder, signature.args[1], *arguments[1:])
        whole = builder.fptosi(builder.load(source, align=64), ir.VectorType(ir.IntType(32), LANES))
        builder.store(whole, target, align=align)
        return context.get_dummy_value()

    return types.void(wave, array, types.intp), emit


@intrinsic
def _gather_scalars(typing: Any, texels: Any, indices: Any, wave: Any) -> Any:
    """Lane by lane: loads and stores that no pass makes vectors of."""

    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        texels, indices, wave = (
            make_array(array_type)(context, builder, argument).data
            for array_type, argument in zip(signature.args, arguments, strict=True)
        )
        for lane in range(LANES):
            at = ir.Constant(ir.IntType(64), lane)
            index = builder.zext(builder.load(builder.gep(indices, [at])), ir.IntType(64))
            builder.store(builder.load(builder.gep(texels, [index])), builder.gep(wave, [at]))
        return context.get_dummy_value()

    return types.void(texels, indices, wave), emit


def _folded(context: Any, builder: Any, array_type: Any, array: Any, comparison: str) -> Any:
    """The one lane that is left after each comparison of the lower half of the lanes with the upper one."""
    source, _ = _vector(context, builder, array_type, array)
    left, half = builder.load(source, align=64), LANES
    while half > 1:
        half //= 2
        low, high = (
            builder.shuffle_vector(
                left, left, ir.Constant(ir.VectorType(ir.IntType(32), half), list(range(at, at + half)))
            )
            for at in (0, half)
        )
        left = builder.select(builder.fcmp_ordered(comparison, low, high), low, high)
    return builder.extract_element(left, ir.Constant(ir.IntType(32), 0))


@intrinsic
def _smallest_of_vector(typing: Any, wave: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _folded(context, builder, signature.args[0], arguments[0], "<")

    return types.float64(wave), emit


@intrinsic
def _largest_of_vector(typing: Any, wave: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _folded(context, builder, signature.args[0], arguments[0], ">")

    return types.float64(wave), emit


load = emitted(_load, _load_vector)
"""load(array, first, wave): copy a wave's elements, from `first`, to its lanes."""

load_indices = emitted(_load_indices, _load_index_vector)
"""load_indices(array, first, wave): the same from indices, int32, to lanes of float64, which hold them exactly."""

store = emitted(_store, _store_vector)
"""store(wave, array, first): copy the lanes of a wave to their elements."""

store_indices = emitted(_store_indices, _store_index_vector)
"""store_indices(wave, array, first): the same for indices that the wave holds as floats."""

gather = emitted(_gather, _gather_scalars)
"""gather(texels, indices, wave): read the elements that the lanes of `indices` (int32, none negative) name."""

smallest = emitted(_smallest, _smallest_of_vector)
"""smallest(wave): the smallest of its lanes."""

largest = emitted(_largest, _largest_of_vector)
"""largest(wave): the largest of its lanes."""
