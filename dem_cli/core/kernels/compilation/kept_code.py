"""Kept machine code: kernels loaded from disk that run without numba, which takes longer to load than small cases take.

What numba compiles is object code with a function for Python, which needs numba around it, and the kernel itself. That
takes numbers and addresses, and calls nothing but functions of C: LLVM links it alone, and it is called by ctypes with
one frame, in which the arguments lie as numba passes them (entries.py, which also decides what may be kept). Where
anything is missing or other than it was, numba does it: other types, processor or options, another system than Linux
on x86-64, a damaged file.
"""

from __future__ import annotations

import ctypes
import hashlib
import json
import os
import platform
import sys
import zlib
from array import array
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from threading import get_ident
from typing import Any, NamedTuple

from dem_cli.core.kernels.compilation.cache_folder import cache_folder, fingerprint
from dem_cli.core.kernels.compilation.kinds import WORD, OtherTypes, kind_of, words_of, words_of_kind

__all__ = ["Header", "KeptKernel", "keep", "kept_kernel", "may_be_kept"]

_HARMLESS = {"NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS"}  # options of numba that machine code does not depend on
_RESULTS: dict[str, Any] = {"i": ctypes.c_int64, "d": ctypes.c_double, "b": ctypes.c_bool, "": None}
_engines: list[Any] = []  # of LLVM, which own the code that runs


class Header(NamedTuple):
    """Header of a file of machine code."""

    kinds: list[str]  # of the arguments
    result: str  # "i", "d", "b" or "" (nothing)
    entry: str  # name of the function to be called
    needed: list[str]  # functions that it calls, by name
    unused: list[str]  # that others in the file call, which nobody calls
    check: int  # sum of all before and of the code


# -- calls -----------------------------------------------------------------------------------------


class _Frame:
    """Arguments of a kernel in memory, of one thread: a word for errors, then one argument after the other."""

    def __init__(self, places: list[int], size: int, n: int) -> None:
        self.places = places
        self.words = array("q", bytes(WORD * size))
        self.address = self.words.buffer_info()[0]
        self.last: list[Any] = [None] * n
        self.held: list[list[Any]] = [[] for _ in range(n)]


class KeptKernel:
    """Kernel for arguments of some kinds, compiled in an earlier process. Threads may call it at the same time."""

    def __init__(self, header: Header, function: Callable[[int], Any]) -> None:
        self.kinds, self._function, self._frames = header.kinds, function, dict[int, _Frame]()
        self._places, self._size = [], 1
        for kind in self.kinds:
            self._places.append(self._size)
            self._size += words_of_kind(kind)

    def __call__(self, *arguments: Any) -> Any:
        """Run the kernel. Raises OtherTypes where it was compiled for other ones."""
        thread = get_ident()
        frame = self._frames.get(thread)
        if frame is None:
            frame = self._frames[thread] = _Frame(self._places, self._size, len(self.kinds))
        last = frame.last
        if len(arguments) != len(last):
            raise OtherTypes
        for place, value in enumerate(arguments):
            if value is not last[place]:
                self._put(frame, place, value)
        found = self._function(frame.address)
        if frame.words[0]:
            raise RuntimeError(f"compiled code failed, {frame.words[0]}")
        return found

    def __deepcopy__(self, known: dict[int, Any]) -> KeptKernel:
        return self

    def _put(self, frame: _Frame, place: int, value: Any) -> None:
        """Store an argument that differs from that of the last call of this thread. What it is made of stays where it
        is in memory.
        """
        kind, here = self.kinds[place], frame.places[place]
        if kind == "i" and type(value) is int:  # most of them
            frame.words[here] = value
        elif kind_of(value) != kind:
            raise OtherTypes
        else:
            held: list[Any] = []
            words = array("q", words_of(value, held))
            frame.words[here : here + len(words)] = words
            frame.held[place] = held
        frame.last[place] = value


# -- files -----------------------------------------------------------------------------------------


@cache
def may_be_kept() -> bool:
    """Test whether machine code can be kept here: unmodified numba, on a system that this was tried on."""
    options = {name for name in os.environ if name.startswith("NUMBA_")}
    return (
        sys.platform == "linux"
        and platform.machine() == "x86_64"
        and ctypes.sizeof(ctypes.c_void_p) == WORD
        and not options - _HARMLESS
        and not Path(".numba_config.yaml").exists()
    )


def _file(function: Callable, kinds: list[str]) -> Path:
    from llvmlite import binding

    processor = binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()
    key = hashlib.sha256(repr((fingerprint(function), kinds, processor)).encode()).hexdigest()
    return cache_folder() / "kept" / f"{key[:32]}.code"


def _check(header: Header, code: bytes) -> int:
    """Compute a checksum of a file, as a damaged header would call what is not there."""
    return zlib.crc32(code, zlib.crc32(json.dumps(header[:-1]).encode()))


def keep(function: Callable, header: Header, code: bytes) -> None:
    """Write the object code of a kernel to disk; where that fails, numba's own cache remains."""
    data = json.dumps(header._replace(check=_check(header, code))._asdict()).encode() + b"\n" + code
    import tempfile  # with half of the standard library

    with suppress(OSError):
        place = _file(function, header.kinds)
        place.parent.mkdir(exist_ok=True)
        handle, name = tempfile.mkstemp(dir=place.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        Path(name).replace(place)


def kept_kernel(function: Callable, arguments: tuple[Any, ...]) -> KeptKernel | None:
    """Load a kernel for some arguments from disk; None where no file can run here."""
    if not may_be_kept():
        return None
    try:
        kinds = [kind_of(value) for value in arguments]
        first, _, code = _file(function, kinds).read_bytes().partition(b"\n")
    except (OtherTypes, OSError):
        return None
    try:
        header = Header(**json.loads(first))
        if header.kinds != kinds or _check(header, code) != header.check:
            return None
    except (ValueError, TypeError):
        return None
    with suppress(OSError):
        return KeptKernel(header, _linked(header, code))
    return None


def _linked(header: Header, code: bytes) -> Callable[[int], Any]:
    """Link the function of a file, ready to run. Raises OSError where something that it calls is not there."""
    from llvmlite import binding

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    machine = binding.Target.from_default_triple().create_target_machine(
        reloc="static", codemodel="jitdefault", jit=True
    )
    engine = binding.create_mcjit_compiler(binding.parse_assembly(""), machine)
    missing = [name for name in header.needed if not binding.address_of_symbol(name)]
    if missing:
        raise OSError(f"no {missing}")
    nobody = ctypes.cast(ctypes.pythonapi.Py_FatalError, ctypes.c_void_p).value
    for name in header.unused:  # LLVM asks for them before it links
        if not binding.address_of_symbol(name):
            binding.add_symbol(name, nobody)
    engine.add_object_file(binding.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)
    made = ctypes.CFUNCTYPE(_RESULTS[header.result], ctypes.c_void_p)
    return made(engine.get_function_address(header.entry))
