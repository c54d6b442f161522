"""Compilation of callees, functions that only compiled functions call: they are kept as LLVM code inside their callers.

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
    """Dummy memory for the machine code of a callee: numba writes the address of its environment there."""

    @staticmethod
    def set_env(name: str, environment: object) -> None:
        """Ignore the environment: a callee has no machine code."""


class CalleeLibrary(JITCodeLibrary):
    """LLVM code of a callee with its own callees, not optimised: whoever takes it in optimises it."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def finalize(self) -> None:
        """Link the code of all callees; nothing may be added any more."""
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: a callee has no address."""
        self._ensure_finalized()
        return 0

    @property
    def codegen(self) -> Any:
        """Return dummy memory in the place of the engine that would run the code."""
        return _NoProcess


@register_pass(mutates_CFG=False, analysis_only=False)
class CalleePass(FunctionPass):
    """Compiler pass that gives a callee a library without machine code."""

    _name = "callee_library"
    library: type[JITCodeLibrary] = CalleeLibrary

    def __init__(self) -> None:
        FunctionPass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        """Set the library that lowering uses."""
        state.library = self.library(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return True


class KernelLibrary(JITCodeLibrary):
    """Code of a kernel, optimised together with all that it calls."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout


@register_pass(mutates_CFG=False, analysis_only=False)
class KernelPass(CalleePass):
    """Compiler pass that gives a kernel its library."""

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
    """Compiler of callees: numba's own passes without those that nothing here needs."""

    library: type[FunctionPass] = CalleePass

    def define_pipelines(self) -> list[PassManager]:
        """Define the pipeline of passes for callees, as numba asks for it."""
        (passes,) = super().define_pipelines()
        passes.passes = [(step, word) for step, word in passes.passes if step not in UNUSED]
        passes.add_pass_after(self.library, NoPythonSupportedFeatureValidation)
        passes.finalize()
        return [passes]


class KernelCompiler(CalleeCompiler):
    """Compiler of kernels, which get an entry that runs without numba."""

    library = KernelPass

    def define_pipelines(self) -> list[PassManager]:
        """Define the pipeline of passes for kernels."""
        (passes,) = super().define_pipelines()
        swapped = [(KernelLowering if step is NativeLowering else step, word) for step, word in passes.passes]
        passes.passes = swapped
        passes.finalize()
        return [passes]


CALLEE: dict[str, Any] = {"pipeline_class": CalleeCompiler, "no_cfunc_wrapper": True}  # options of numba's `jit`
KERNEL: dict[str, Any] = {"pipeline_class": KernelCompiler}
