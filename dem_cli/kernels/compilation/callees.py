"""Compilation of callees, functions that only compiled functions call: LLVM and the cache get them within these.

Numba makes of each of them a wrapper for C, optimises it and turns it into machine code that nothing ever runs: the
kernel takes its LLVM code in, optimises it where it stands and is all that is executed. A kernel has up to a hundred.
"""

from __future__ import annotations

from typing import Any
from weakref import WeakSet

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

from dem_cli.kernels.compilation.entries import KernelLowering

__all__ = ["CALLEE", "KERNEL", "CalleeCompiler", "comes_from_disk"]


class _NoProcess:
    """Where the machine code of a callee would be: numba writes the address of its environment there."""

    @staticmethod
    def set_env(name: str, environment: object) -> None:
        """Nothing to write to."""


class PackageLibrary(JITCodeLibrary):
    """LLVM code of a function of this package, which is not optimised function by function.

    callees: what is called from here, directly or not; kernels: those among it, which were optimised when they were
    compiled. LLVM would optimise the largest again in every loop in space, half of the time that these take.
    """

    callees: dict[JITCodeLibrary, None]
    kernels: dict[JITCodeLibrary, None]

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def _gather(self) -> None:
        """What is called from here, each once."""
        self.callees, self.kernels = {}, {}
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            if is_of_kernel(library):
                self.kernels[library] = None
            else:
                self.callees |= {library: None, **getattr(library, "callees", {})}
                self.kernels |= getattr(library, "kernels", {})


class CalleeLibrary(PackageLibrary):
    """LLVM code of a callee, as it was written: the kernel takes in all that it calls, and optimises it."""

    def finalize(self) -> None:
        """Nothing may be added any more."""
        self._gather()
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "external":
                function.linkage = "linkonce_odr"  # as numba has it in the copy that it would make
        self._shared_module = self._final_module
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


class KernelLibrary(PackageLibrary):
    """Code of a kernel, optimised with its callees; kernels that it calls come in behind."""

    def finalize(self) -> None:
        """As numba's own."""
        self._gather()
        self._linking_libraries = list(self.callees)
        super().finalize()

    def _optimize_final_module(self) -> None:
        super()._optimize_final_module()
        for library in self.kernels:
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)


_from_disk: WeakSet[JITCodeLibrary] = WeakSet()


def is_of_kernel(library: JITCodeLibrary) -> bool:
    """Whether a library is that of a kernel, compiled here or before."""
    return isinstance(library, KernelLibrary) or library in _from_disk


def comes_from_disk(library: JITCodeLibrary) -> None:
    """Notes that a library is that of a kernel, which numba reads as one like any other."""
    _from_disk.add(library)


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
