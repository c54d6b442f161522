"""Check of the private names of numba and LLVM that the package's own way uses.

`A.f(self, x)` is a function with these parameters, `A.f` anything, `A: _x` something that instances of A keep.
"""

from __future__ import annotations

import importlib
import inspect
from typing import Any

import numba

from dem_cli.core.kernels.compilation.switch import Surprise

__all__ = ["PRIVATE_NAMES", "TRIED", "check_private_names"]

TRIED = "0.68."  # versions of numba that begin so
PRIVATE_NAMES: dict[str, tuple[str, ...]] = {
    "llvmlite.binding": ("parse_bitcode(bitcode, context)",),
    "llvmlite.ir": (
        "Constant", "Function", "FunctionType", "IRBuilder.atomic_rmw(self, op, ptr, val, ordering, name)",
        "IRBuilder.load_atomic(self, ptr, ordering, align, name, typ)", "IntType", "VoidType",
    ),
    "numba.core.base": (
        "BaseContext.create_module(self, name)", "BaseContext.get_abi_sizeof(self, ty)",
        "BaseContext.get_constant(self, ty, val)", "BaseContext.get_constant_null(self, ty)",
        "BaseContext.get_dummy_value(self)", "BaseContext.get_python_api(self, builder)",
        "BaseContext.get_value_type(self, ty)", "BaseContext.subtarget(self, kws)", "_has_loc(fn)",
    ),
    "numba.core.caching": (
        "CompileResultCacheImpl.rebuild(self, target_context, payload)", "FunctionCache.__init__(self, py_func)",
        "FunctionCache._guard_against_spurious_io_errors(self)", "FunctionCache._index_key(self, sig, codegen)",
        "FunctionCache._load_overload(self, sig, target_context)", "FunctionCache: _cache_file",
        "FunctionCache: _impl", "FunctionCache: _py_func", "FunctionCache.load_overload(self, sig, target_context)",
        "FunctionCache.save_overload(self, sig, data)", "IndexDataCacheFile._data_name(self, number)",
        "IndexDataCacheFile: _data_name_pattern", "IndexDataCacheFile.flush(self)",
        "IndexDataCacheFile.load(self, key)",
    ),
    "numba.core.callconv": (
        "CPUCallConv.call_function(self, builder, callee, resty, argtys, args, attrs)",
        "CPUCallConv.get_function_type(self, restype, argtypes)",
    ),
    "numba.core.cgutils": (
        "_StructProxy._getvalue(self)", "alloca_once(builder, ty, size, name, zfill)", "false_bit",
        "gep(builder, ptr, inds, kws)",
        "gep_inbounds(builder, ptr, inds, kws)", "get_or_insert_function(module, fnty, name)",
        "ir.FunctionType", "ir.IntType", "is_not_null(builder, val)", "true_bit", "unpack_tuple(builder, tup, count)",
    ),
    "numba.core.codegen": (
        "CPUCodegen.magic_tuple(self)", "CPUCodegen: _data_layout", "JITCodeLibrary.__init__(self, codegen, name)",
        "JITCodeLibrary._ensure_finalized(self)", "JITCodeLibrary._finalize_dynamic_globals(self)",
        "JITCodeLibrary._get_compiled_object(self)", "JITCodeLibrary._get_module_for_linking(self)",
        "JITCodeLibrary._optimize_functions(self, ll_module)", "JITCodeLibrary: _codegen",
        "JITCodeLibrary: _final_module", "JITCodeLibrary: _finalized", "JITCodeLibrary: _linking_libraries",
        "JITCodeLibrary: _reload_init", "JITCodeLibrary.add_ir_module(self, ir_module)", "JITCodeLibrary.codegen",
        "JITCodeLibrary.enable_object_caching(self)", "JITCodeLibrary.finalize(self)",
        "JITCodeLibrary.get_pointer_to_function(self, name)",
    ),
    "numba.core.compiler": ("Compiler.define_pipelines(self)",),
    "numba.core.compiler_machinery": (
        "FunctionPass.run_pass(self, args, kwargs)",
        "PassManager.add_pass_after(self, pass_cls, location)", "PassManager.finalize(self)", "PassManager: passes",
        "register_pass(mutates_CFG, analysis_only)",
    ),
    "numba.core.datamodel": ("default_manager", "models.OpaqueModel"),
    "numba.core.datamodel.models": ("StructModel.get_field_position(self, field)",),
    "numba.core.dispatcher": ("Dispatcher: _cache", "Dispatcher: overloads"),
    "numba.core.event": ("Listener.on_end(self, event)", "Listener.on_start(self, event)", "register(kind, listener)"),
    "numba.core.funcdesc": ("FunctionDescriptor.llvm_cfunc_wrapper_name", "FunctionDescriptor.llvm_func_name"),
    "numba.core.imputils": ("impl_ret_borrowed(ctx, builder, retty, ret)", "lower_getattr_generic(ty)"),
    "numba.core.lowering": ("Lower.create_cfunc_wrapper(self)",),
    "numba.core.pythonapi": (
        "PythonAPI.err_set_string(self, exctype, msg)", "PythonAPI.numba_array_adaptor(self, ary, ptr)",
        "PythonAPI.tuple_getitem(self, tup, idx)",
    ),
    "numba.core.runtime.nrt": ("rtsys",),
    "numba.core.targetconfig": (
        "ConfigStack.top_or_none()", "TargetConfig.__eq__(self, other)",
        "TargetConfig: _values",
    ),
    "numba.core.typed_passes": (
        "AnnotateTypes", "DumpParforDiagnostics", "NativeLowering.lowering_class", "NoPythonSupportedFeatureValidation",
        "NopythonRewrites",
    ),
    "numba.core.types": ("Array.copy(self, dtype, ndim, layout, readonly)", "Tuple", "Type", "UniTuple", "intp"),
    "numba.core.types.functions": (
        "BaseFunction.get_call_type(self, context, args, kws)", "BaseFunction.get_impl_key(self, sig)",
    ),
    "numba.core.typing.templates": (
        "AttributeTemplate", "_OverloadFunctionTemplate._build_impl(self, cache_key, args, kws)",
        "_OverloadFunctionTemplate._get_impl(self, args, kws)", "_OverloadFunctionTemplate: _impl_cache",
        "_OverloadFunctionTemplate: _jit_options", "infer_getattr(item)",
    ),
    "numba.core.untyped_passes": ("InlineClosureLikes", "WithLifting"),
    "numba.np.arrayobj": (
        "make_array(array_type)", "populate_array(array, data, shape, strides, itemsize, meminfo, parent)",
    ),
    "numba.np.numpy_support": ("as_dtype(nbtype)",),
}  # fmt: skip


def check_private_names() -> None:
    """Check versions and private names of numba and LLVM; raises Surprise where one is missing or differs."""
    if not numba.__version__.startswith(TRIED):
        raise Surprise(f"numba {numba.__version__}; {TRIED}x is what this was tried with")
    for module, names in PRIVATE_NAMES.items():
        for name in names:
            if not _there(module, name):
                raise Surprise(f"{module} of numba {numba.__version__} has no {name}")


def _there(module: str, name: str) -> bool:
    """Test whether a name exists as the table says."""
    path, kept = name.partition("(")[0].partition(": ")[::2]
    found: Any = importlib.import_module(module)
    for part in path.split("."):
        found = getattr(found, part, None)
        if found is None:
            return False
    if kept:
        return any(kept in _names_used(each) for base in found.__mro__ for each in vars(base).values())
    if not name.endswith(")"):
        return True
    return ", ".join(inspect.signature(found).parameters) == name.partition("(")[2][:-1]


def _names_used(function: Any) -> tuple[str, ...]:
    code = getattr(inspect.unwrap(function) if callable(function) else function, "__code__", None)
    return () if code is None else tuple(code.co_names)
