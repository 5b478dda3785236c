"""Parts of kernels: no machine code of their own, in whatever they are linked into."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import pytest

from ibr_ref import jit, linking

pytestmark = pytest.mark.skipif(jit.config.DISABLE_JIT, reason="nothing is compiled")

GONE = "linking.py is built on it: look there before you raise Numba's upper bound in pyproject.toml"


def _of_numba(function: Any) -> Any:
    """Compiled as anybody compiles."""
    return numba.njit(error_model="numpy")(function)


def _libraries(dispatcher: Any) -> list[Any]:
    return [result.library for result in dispatcher.overloads.values()]


@pytest.fixture
def root() -> Any:
    """Two levels of device functions; the lower one uses a function of Numba's own library."""

    def clipped(x: float) -> float:
        return max(x, 0.0)

    lower = jit.device(clipped)

    def clipped_root(x: float) -> float:
        return float(np.sqrt(lower(x)))

    return jit.device(clipped_root)


@pytest.fixture(autouse=True)
def _nothing_kept(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jit, "_cache_directory", lambda room: str(tmp_path))


VALUES = np.array([-1.0, 0.0, 4.0, 9.0])
ROOTS = np.array([0.0, 0.0, 2.0, 3.0])


def test_a_parallel_kernel_is_made_of_its_parts(root: Any) -> None:
    def roots(values: Any, out: Any) -> None:
        for i in jit.prange(len(values)):
            out[i] = root(values[i])

    kernel, out = jit.kernel(roots), np.empty(4)
    kernel(VALUES, out)
    np.testing.assert_array_equal(out, ROOTS)
    assert [type(library) for library in _libraries(kernel)] == [linking.Whole]
    assert [type(library) for library in _libraries(root)] == [linking.Part]


def test_a_part_has_no_machine_code(root: Any) -> None:
    _of_numba(lambda x: root(x))(4.0)
    (library,) = _libraries(root)
    (result,) = root.overloads.values()
    assert library.get_pointer_to_function(result.fndesc.llvm_func_name) == 0
    engine = library._codegen._engine
    assert not engine.get_function_address(result.fndesc.llvm_func_name), GONE


def test_what_numba_compiles_links_parts_with_all_that_they_call(root: Any) -> None:
    assert [_of_numba(lambda x: root(x) + 1.0)(x) for x in VALUES] == [1.0, 1.0, 3.0, 4.0]


def test_numba_s_own_functions_that_were_parts_are_used_by_others_too(root: Any) -> None:
    """`max` is compiled here as a part first, if nothing has before; then other code calls the same."""

    def first(values: Any) -> None:
        for i in range(len(values)):
            values[i] = root(values[i])

    values = VALUES.copy()
    jit.routine(first)(values)
    np.testing.assert_array_equal(values, ROOTS)
    assert _of_numba(lambda x: max(x, 0.0))(-2.0) == 0.0


def test_a_kernel_is_read_from_the_disk(root: Any, tmp_path: Any) -> None:
    def one(values: Any, out: Any) -> None:
        for i in jit.prange(len(values)):
            out[i] = root(values[i])

    jit.kernel(one)(VALUES, np.empty(4))
    assert list(tmp_path.rglob("*.nbi"))
    names: list[str] = []
    again, out = jit.kernel(one), np.empty(4)
    with jit.compilations(names.append):
        again(VALUES, out)
    np.testing.assert_array_equal(out, ROOTS)
    assert names == []


def test_libraries_of_others_are_what_they_were(root: Any) -> None:
    def doubled(values: Any) -> None:
        for i in range(len(values)):
            values[i] = 2.0 * root(values[i])

    jit.routine(doubled)(VALUES.copy())
    other = _of_numba(lambda x: 2.0 * x)
    other(1.0)
    assert [type(library) for library in _libraries(other)] == [numba.core.codegen.JITCodeLibrary], GONE
