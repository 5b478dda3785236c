"""The disk cache of kernels: keyed by every source that a kernel can be made of, and by no other."""

from __future__ import annotations

from ibr_ref import jit


def _rooms(room: str) -> set[str]:
    return {source.relative_to(jit.PACKAGE).parts[0] for source in jit._sources(room)}


def test_a_method_s_kernels_hang_on_the_pipeline_and_on_their_own_folder() -> None:
    assert _rooms("displacement") == {"jit.py", "pipeline", "displacement"}


def test_the_pipeline_s_kernels_hang_on_no_method() -> None:
    assert _rooms("pipeline") == {"jit.py", "pipeline"}


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
