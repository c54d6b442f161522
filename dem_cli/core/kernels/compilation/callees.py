"""Compilation of callees, functions that only compiled functions call: LLVM and the cache get them within these.

Numba makes of each of them a wrapper for C, optimises it and turns it into machine code that nothing ever runs: the
kernel takes its LLVM code in, optimises it where it stands and is all that is executed. A kernel has up to a hundred.
"""

from __future__ import annotations

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import FunctionPass, PassManager, register_pass
from numba.core.typed_passes import (
    AnnotateTypes,
    DumpParforDiagnostics,
    NativeLowering,
    NopythonRewrites,
    NoPythonSupportedFeatureValidation,
)
from numba.core.untyped_passes import InlineClosureLikes, WithLifting

from dem_cli.core.kernels.compilation.entries import KernelLowering

__all__ = ["CALLEE", "KERNEL", "CalleeCompiler"]


class _NoProcess:
    """Where the machine code of a callee would be: numba writes the address of its environment there."""

    @staticmethod
    def set_env(name: str, environment: object) -> None:
        """Nothing to write to."""


class CalleeLibrary(JITCodeLibrary):
    """LLVM code of a callee with what it calls, as it was written: whoever takes it in optimises it."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def finalize(self) -> None:
        """Takes in what it calls; nothing may be added any more."""
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """There is none."""
        self._ensure_finalized()
        return 0

    @property
    def codegen(self) -> Any:
        """What would run it."""
        return _NoProcess


@register_pass(mutates_CFG=False, analysis_only=False)
class CalleePass(FunctionPass):
    """Gives a function a library that makes no machine code."""

    _name = "callee_library"
    library: type[JITCodeLibrary] = CalleeLibrary

    def __init__(self) -> None:
        FunctionPass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        """Lowering takes the library that it finds."""
        state.library = self.library(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return True


class KernelLibrary(JITCodeLibrary):
    """Code of a kernel, optimised with all that it calls: not function by function before."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout


@register_pass(mutates_CFG=False, analysis_only=False)
class KernelPass(CalleePass):
    """Gives a kernel its library."""

    _name = "kernel_library"
    library = KernelLibrary


UNUSED = (  # kernels have no `with`, no functions inside of functions, no expressions of whole arrays, no annotations
    WithLifting,
    InlineClosureLikes,
    NopythonRewrites,
    AnnotateTypes,
    DumpParforDiagnostics,
)


class CalleeCompiler(Compiler):
    """Numba's own passes but those that nothing here needs, with a library for callees."""

    library: type[FunctionPass] = CalleePass

    def define_pipelines(self) -> list[PassManager]:
        """One of them, as numba has it."""
        (passes,) = super().define_pipelines()
        passes.passes = [(step, word) for step, word in passes.passes if step not in UNUSED]
        passes.add_pass_after(self.library, NoPythonSupportedFeatureValidation)
        passes.finalize()
        return [passes]


class KernelCompiler(CalleeCompiler):
    """The same for kernels, which get an entry."""

    library = KernelPass

    def define_pipelines(self) -> list[PassManager]:
        """One of them."""
        (passes,) = super().define_pipelines()
        swapped = [(KernelLowering if step is NativeLowering else step, word) for step, word in passes.passes]
        passes.passes = swapped
        passes.finalize()
        return [passes]


CALLEE: dict[str, Any] = {"pipeline_class": CalleeCompiler, "no_cfunc_wrapper": True}  # options of numba's `jit`
KERNEL: dict[str, Any] = {"pipeline_class": KernelCompiler}
