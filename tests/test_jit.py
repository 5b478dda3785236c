"""The disk cache of kernels: keyed by every source that a kernel can be made of, and by no other. What kernels say."""

from __future__ import annotations

import importlib
import inspect
import os
import pkgutil
import subprocess
import sys
import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

import ibr_ref
from ibr_ref import jit

ROOT = Path(__file__).parents[1]


def _rooms(room: str) -> set[str]:
    return {source.relative_to(jit.PACKAGE).parts[0] for source in jit._sources(room)}


def test_a_method_s_kernels_hang_on_the_pipeline_and_on_their_own_folder() -> None:
    assert _rooms("displacement") == {"jit.py", "linking.py", "pipeline", "displacement"}


def test_the_pipeline_s_kernels_hang_on_no_method() -> None:
    assert _rooms("pipeline") == {"jit.py", "linking.py", "pipeline"}


def test_kernels_outside_the_package_may_hang_on_all_of_it() -> None:
    assert jit._sources("") == sorted(jit.PACKAGE.rglob("*.py"))


def test_the_room_is_that_of_the_function_s_module() -> None:
    from ibr_ref.displacement.march import linear_search
    from ibr_ref.pipeline.sampling import lerp

    assert jit._room(linear_search.py_func if hasattr(linear_search, "py_func") else linear_search) == "displacement"
    assert jit._room(lerp.py_func if hasattr(lerp, "py_func") else lerp) == "pipeline"
    assert jit._room(test_the_room_is_that_of_the_function_s_module) == ""


def test_rooms_have_keys_of_their_own() -> None:
    assert len({jit._digest(room) for room in ("", "pipeline", "displacement")}) == 3


# --- Annotations -------------------------------------------------------------------------------------------------------

ROOMS = tuple(f"ibr_ref.{room}" for room in ("affine", "bench", "displacement", "pipeline", "shadows", "splatting"))
"""Where there are kernels."""


def test_kernels_say_what_they_take_and_return() -> None:
    for found in pkgutil.walk_packages(ibr_ref.__path__, "ibr_ref."):
        if found.name.startswith(ROOMS):
            importlib.import_module(found.name)
    silent, asked = [], 0
    for compiled in jit.functions:
        function = getattr(compiled, "py_func", compiled)
        module = function.__module__
        if not module.startswith("ibr_ref."):
            continue
        asked += 1
        missing = {*inspect.signature(function).parameters, "return"} - set(function.__annotations__)
        silent += [f"{module}.{function.__name__}: {', '.join(sorted(missing))}"] if missing else []
    assert asked > 300
    assert silent == []


# --- Names of Numba that it does not promise ---------------------------------------------------------------------------

GONE = "jit.py is built on it: look there before you raise Numba's upper bound in pyproject.toml"


@pytest.fixture
def tripled() -> Any:
    """A device function of this file, with nothing compiled yet."""

    def triple(x: float) -> float:
        return 3.0 * x

    return jit.device(triple)


def test_the_configuration_has_what_is_set() -> None:
    from numba.core import config

    for name in ("CACHE_DIR", "DISABLE_JIT", "BOUNDSCHECK"):
        assert hasattr(config, name), f"numba.core.config.{name}: {GONE}"


@pytest.mark.skipif(jit.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_dispatcher_has_the_methods_that_are_replaced(tripled: Any) -> None:
    import numba

    for name in ("_insert", "_compile_for_args"):
        assert callable(getattr(numba.njit(lambda x: x), name, None)), f"{name} of a dispatcher: {GONE}"
        assert name in vars(tripled), name


@pytest.mark.skipif(jit.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_device_function_answers_to_compiled_code_and_to_python(tripled: Any) -> None:
    """Without the wrappers that let Python call it: a call from there goes to another compilation."""
    import numba

    def caller(x: float) -> float:
        return tripled(x) + 1.0

    assert numba.njit(caller)(2.0) == 7.0
    assert tripled(2.0) == 6.0, f"the call from Python: {GONE}"
    assert tripled.targetoptions["no_cpython_wrapper"], f"no_cpython_wrapper: {GONE}"
    assert tripled.targetoptions["no_cfunc_wrapper"], f"no_cfunc_wrapper: {GONE}"


@pytest.mark.skipif(jit.config.DISABLE_JIT, reason="nothing is compiled")
def test_compilations_are_told_by_name() -> None:
    import numba

    def counted(x: int) -> int:
        return x + 1

    names: list[str] = []
    with jit.compilations(names.append):
        assert numba.njit(counted)(1) == 2
    assert names == ["counted"], f"the event numba:compile and its data: {GONE}"


def test_numba_s_bound_is_the_next_version_that_nobody_has_tried() -> None:
    import numba
    from packaging.requirements import Requirement

    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    (wanted,) = [r for r in map(Requirement, project["dependencies"]) if r.name == "numba"]
    assert {part.operator for part in wanted.specifier} == {">=", "<"}, "numba: an upper bound"
    assert numba.__version__ in wanted.specifier, GONE


def test_kernels_are_kept_in_the_user_s_cache_folder() -> None:
    code = "from ibr_ref import jit; print(jit._cache_directory('pipeline'))"
    with TemporaryDirectory() as folder:
        kept = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
        homes = {"XDG_CACHE_HOME": folder, "LOCALAPPDATA": folder, "HOME": folder}
        made = subprocess.run(
            [sys.executable, "-c", code], env=kept | homes, capture_output=True, text=True, check=True
        )
        place = Path(made.stdout.strip())
        assert place.is_relative_to(folder)
        assert "ibr_ref" in place.parts


def test_a_cache_that_cannot_be_written_is_said_once(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    code = "from ibr_ref import jit; jit._cache_directory('pipeline'); jit._cache_directory('shadows')"
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "file")}
    made = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    (line,) = made.stderr.splitlines()
    assert line.startswith(f"ibr_ref: kernels cannot be kept in {tmp_path / 'file'} (Not a directory)")
    assert "NUMBA_CACHE_DIR" in line
