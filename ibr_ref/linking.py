"""What a kernel is made of becomes machine code once, in the kernel itself.

Numba optimizes every function that it compiles, together with all that it calls, and makes machine code of it; so it does
with the body of a parallel loop, and with each of the two wrappers around that. For what only compiled code calls this is
work for nothing: it is linked into its callers as LLVM IR, and optimized there again, so that a kernel was made five times.
Here all of it is a `Part`, which waits. The kernel, a `Whole`, links its parts, is optimized, and becomes machine code.

It is built on private names of Numba's code generator: `tests/test_linking.py` says whether a newer one still has them.
"""

# mypy: allow-untyped-calls
# Numba has types for few of the names below.

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler

__all__ = ["DeviceCompiler", "KernelCompiler"]


class _NoMachineCode:
    """The code generator of a part, as far as Numba asks for it there."""

    def set_env(self, name: str, environment: Any) -> None:
        """Nothing: there is no place for one, and only what raises or prints would read it."""


class Part(JITCodeLibrary):
    """A function that is linked into others."""

    _whole: Any = None
    """With all that it calls, once a library of Numba's own kind has asked for it."""

    @property
    def codegen(self) -> Any:
        return _NoMachineCode()

    def finalize(self) -> None:
        """Nothing but the linkage: where it is linked, nothing refers to it yet, and still it must not be dropped."""
        self._raise_if_finalized()
        _link_as(self._final_module, llvm.Linkage.external, "weak_odr")
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """0: nobody calls it."""
        return 0

    def _get_module_for_linking(self) -> Any:
        self._ensure_finalized()
        if self._whole is None:
            self._whole = self._final_module.clone()
            _link(self, self._whole)
            _link_as(self._whole, llvm.Linkage.weak_odr, "linkonce_odr")
        return self._whole


def _link_as(module: Any, before: Any, after: str) -> None:
    """Give the functions that a module defines another linkage."""
    for function in module.functions:
        if not function.is_declaration and function.linkage == before:
            function.linkage = after


def _link(library: Any, module: Any) -> None:
    """Link all that a library hangs on into a module, each once."""
    seen, waiting = {library}, list(library._linking_libraries)
    while waiting:
        other = waiting.pop(0)
        if other in seen:
            continue
        seen.add(other)
        library._reload_init.update(other._reload_init)
        if isinstance(other, Part):
            waiting.extend(other._linking_libraries)
            module.link_in(other._final_module, preserve=True)
        else:
            module.link_in(other._get_module_for_linking(), preserve=True)


class Whole(JITCodeLibrary):
    """A kernel with all its parts."""

    def finalize(self) -> None:
        """Link, optimize, make machine code."""
        self._codegen._check_llvm_bugs()
        self._raise_if_finalized()
        _link(self, self._final_module)
        _link_as(self._final_module, llvm.Linkage.weak_odr, "linkonce_odr")
        self._optimize_final_module()
        self._final_module.verify()
        self._finalize_final_module()


@contextmanager
def _compiled_as_parts(codegen: Any) -> Iterator[None]:
    """Libraries that are made inside are parts. Whoever compiles holds Numba's lock, so that no other thread does."""
    before = codegen._library_class
    codegen._library_class = Part
    try:
        yield
    finally:
        codegen._library_class = before


class DeviceCompiler(Compiler):
    """Compiles a function as a part."""

    def _compile_core(self) -> Any:
        with _compiled_as_parts(self.state.targetctx.codegen()):
            return super()._compile_core()


class KernelCompiler(Compiler):
    """Compiles a kernel: what it calls, and the bodies of its loops, as parts."""

    def _compile_core(self) -> Any:
        codegen = self.state.targetctx.codegen()
        self.state.library = Whole(codegen, self.state.func_id.func_qualname)
        self.state.library.enable_object_caching()
        with _compiled_as_parts(codegen):
            return super()._compile_core()
