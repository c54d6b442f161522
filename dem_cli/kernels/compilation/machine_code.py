"""Machine code of kernels: the side of the door behind which numba is, loaded when a kernel is first called.

The cache folder carries the hash of all sources of kernels and laws, because numba looks only at the
file of the decorated function: a callee edited elsewhere, or a reordered record, would otherwise
go on running old machine code.
"""

from __future__ import annotations

import gc
import hashlib
import importlib
import os
import platform
import sys
import tempfile
import time
import uuid
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any, cast

import numba
from numba import literal_unroll
from numba.core import event
from numba.core.caching import FunctionCache
from numba.core.runtime.nrt import rtsys
from numba.extending import overload as numba_overload
from numba.extending import register_jitable

from dem_cli.kernels.compilation.callees import CALLEE, KERNEL

__all__ = [
    "Compilation",
    "cache_folder",
    "cache_is_cold",
    "compiled",
    "declare_callee",
    "declare_overload",
    "literal_unroll",
]

_ROOT = Path(__file__).resolve().parents[2]


def _source_hash() -> str:
    digest = hashlib.sha256(f"{numba.__version__} {platform.python_version()}".encode())
    for folder in ("kernels", "laws", "links"):
        for source in sorted((_ROOT / folder).rglob("*.py")):
            digest.update(source.name.encode())
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def cache_folder() -> Path:
    """Where compiled code is kept: $DEM_CACHE_DIR, else the user's cache, else a temporary folder."""
    home = os.environ.get("DEM_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    folder = Path(home) / "dem-cli" / _source_hash()
    if _writable(folder):
        return folder
    uid = os.getuid() if hasattr(os, "getuid") else 0
    return Path(tempfile.gettempdir()) / f"dem-cli-{uid}" / folder.name


def cache_is_cold() -> bool:
    """True where nothing was compiled yet for these sources."""
    return next(Path(CACHE).rglob("*.nbi"), None) is None


class _Outermost(event.Listener):
    """Hears where compilation of a kernel begins and ends, not that of what it calls."""

    _depth = 0

    def on_start(self, event: event.Event) -> None:
        """A kernel, or something inside of it."""
        if not self._depth:
            self.begins()
        self._depth += 1

    def on_end(self, event: event.Event) -> None:
        """A kernel, or something inside of it."""
        self._depth -= 1
        if not self._depth:
            self.ends()

    def begins(self) -> None:
        """A kernel."""
        raise NotImplementedError

    def ends(self) -> None:
        """The same kernel."""
        raise NotImplementedError


class Compilation(_Outermost):
    """Compilation that really happens, not what comes from the cache: told when it begins, its seconds counted.

    `with Compilation(tell).heard():` listens; `tell` is called once for each kernel, with what it calls.
    """

    def __init__(self, tell: Callable[[], None]) -> None:
        self.tell, self.seconds, self._begun = tell, 0.0, 0.0

    def heard(self) -> AbstractContextManager:
        """Listens inside of it."""
        return event.install_listener("numba:compile", self)

    def begins(self) -> None:
        """Its time counts, and that of what it calls within it."""
        self._begun = time.perf_counter()
        self.tell()

    def ends(self) -> None:
        """Adds its time."""
        self.seconds += time.perf_counter() - self._begun


class Uncollected(_Outermost):
    """Python collects no garbage while it compiles: it would look at a million live objects again and again.

    That was a fifth of the time of compilation.
    """

    _was_on = False

    def begins(self) -> None:
        """No more from here on."""
        self._was_on = gc.isenabled()
        gc.disable()

    def ends(self) -> None:
        """As it was before."""
        if self._was_on:
            gc.enable()


event.register("numba:compile", Uncollected())


def _load_numba_without_blas() -> None:
    """numba imports scipy.linalg when it first meets an array, only to learn whether there is a BLAS: 0.2 s.

    No kernel here multiplies matrices.
    """
    if "scipy.linalg" not in sys.modules:
        sys.modules["scipy.linalg"] = None  # type: ignore[assignment]  # makes the import fail
        try:
            importlib.import_module("numba.np.arraymath")
        finally:
            del sys.modules["scipy.linalg"]


CACHE = str(cache_folder())
# Numba reads its settings again whenever a variable of its part of the environment has changed, and would from then on
# keep compiled code beside the sources, where nothing tells old code from new.
vars(numba.config)["CACHE_DIR"] = os.environ["NUMBA_CACHE_DIR"] = CACHE


def _made_of(part: Any) -> object:
    """What tells a function, its code or a value in a closure from others: the same in every process."""
    if isinstance(part, FunctionType):
        held = tuple(_made_of(cell.cell_contents) for cell in part.__closure__ or ())
        return part.__module__, part.__qualname__, _made_of(part.__code__), held
    if isinstance(part, CodeType):
        return part.co_code, part.co_names, tuple(map(_made_of, part.co_consts))
    return _made_of(part.py_func) if hasattr(part, "py_func") else repr(part)


class KernelCache(FunctionCache):
    """Compiled code on disk, found again by what the closure of a kernel was made of.

    Numba finds it by the closure as it is pickled, which depends on whether Python had compiled the modules itself or
    read them from `__pycache__`: the second process of a fresh checkout would compile everything again. And it
    numbers files, so that two processes that save two kernels at one time may write one file: here no two share a name.
    """

    def __init__(self, function: Callable) -> None:
        super().__init__(function)
        pattern = self._cache_file._data_name_pattern
        self._cache_file._data_name = lambda number: pattern.format(number=uuid.uuid4().int >> 64)

    def _index_key(self, sig: Any, codegen: Any) -> tuple:
        made_of = hashlib.sha256(repr(_made_of(self._py_func)).encode()).hexdigest()
        return sig, codegen.magic_tuple(), made_of

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """As numba's own, which first gets ready to compile all that it knows: that takes as long as to load numba.

        Kernels call nothing outside of themselves but numba's runtime and functions of C, which are there from the
        start: it would make symbols of others, hashes of strings and threads of its own, known as well.
        """
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            if (found := self._load_overload(sig, target_context)) is not None:
                return found
        _load_numba_without_blas()
        return None


def compiled(function: Callable) -> Callable:
    """The function as machine code, from the disk where it is there. IEEE division, no fast-math."""
    found: Any = numba.njit(error_model="numpy", fastmath=False, nogil=True, **KERNEL)(function)
    found._cache = KernelCache(function)  # as its `enable_caching` does with numba's own
    return cast(Callable, found)


def declare_callee(function: Callable, forced: bool) -> None:
    """Kernels may call this function; forced: it is put in the place of each call, which numba decides otherwise.

    What kernels call allocates nothing and keeps no array, so that references to arrays need no counting: counted at
    each call inside a branching loop, they cost several times the work of a law. (`_nrt`: numba's runtime for them.)
    """
    register_jitable(_nrt=False, **({"forceinline": True} if forced else {}), **CALLEE)(function)


def declare_overload(function: Callable, implementation: Callable) -> None:
    """Kernels may call this function, and get what `implementation` returns for the types of its arguments."""
    numba_overload(function, jit_options=cast(Any, {"_nrt": False, **CALLEE}))(implementation)
