"""Cache folder of compiled kernels, named by a hash of all that their machine code depends on; found without loading
numba.

It carries the hash of all sources that are compiled, because numba looks only at the file of the decorated function:
a callee edited elsewhere, or a reordered record, would otherwise go on running old machine code.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import platform
import shutil
import stat
import tempfile
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

__all__ = ["cache_folder", "cache_is_cold", "compiled_sources", "fingerprint"]

_ROOT = Path(__file__).resolve().parents[3]
_ROOMS = ("core/kernels", "core/laws", "core/links")
_ELSEWHERE = (
    "core/arithmetic/symmetric_factors.py", "core/limit/front_factors.py", "core/limit/compiled_cones.py",
)  # fmt: skip


def _compiler() -> bytes:
    """Return bytes that identify the versions of numba and LLVM."""
    found = b""
    for package in ("numba", "llvmlite"):
        spec = find_spec(package)
        origin = Path(spec.origin) if spec is not None and spec.origin is not None else None
        if origin is None:
            raise ModuleNotFoundError(f"No module named '{package}'", name=package)
        try:
            found += (origin.parent / "_version.py").read_bytes()
        except OSError:  # a package that writes its version elsewhere
            from importlib.metadata import version

            found += version(package).encode()
    return found


def compiled_sources() -> list[Path]:
    """List the source files with functions that are compiled."""
    found = [source for folder in _ROOMS for source in sorted((_ROOT / folder).rglob("*.py"))]
    return found + [_ROOT / name for name in _ELSEWHERE]


def _source_hash() -> str:
    digest = hashlib.sha256(_compiler() + platform.python_version().encode())
    for source in compiled_sources():
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


@cache
def _place(home: str, source_hash: str) -> Path:
    folder = Path(home) / "dem-cli" / source_hash
    if _writable(folder):
        return folder
    uid = os.getuid() if hasattr(os, "getuid") else 0
    temporary = Path(tempfile.gettempdir()) / f"dem-cli-{uid}"
    if not _of_nobody_else(temporary, uid):  # whoever made it would choose the code that runs here
        temporary = Path(tempfile.mkdtemp(prefix="dem-cli-"))
        atexit.register(shutil.rmtree, temporary, ignore_errors=True)
    return temporary / folder.name


def _of_nobody_else(folder: Path, uid: int) -> bool:
    """Test whether a folder in a shared place, made if it is missing, belongs to this user alone."""
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return False
    private = stat.S_ISDIR(found.st_mode) and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    return os.name == "nt" or (private and found.st_uid == uid)


_source_hash_of_process = cache(_source_hash)


def cache_folder() -> Path:
    """Return the folder of compiled code: $DEM_CACHE_DIR, else the user's cache, else a temporary folder."""
    home = os.environ.get("DEM_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    return _place(str(home), _source_hash_of_process())


def cache_is_cold() -> bool:
    """Test whether nothing was compiled yet for these sources."""
    return next(cache_folder().rglob("*.nbi"), None) is None


def fingerprint(function: Callable) -> str:
    """Hash the code of a kernel and all that it closes over; the same in every process."""
    return hashlib.sha256(repr(_made_of(function)).encode()).hexdigest()


def _made_of(part: Any) -> object:
    """Reduce a function, its code or a value in a closure to plain values that identify it."""
    if isinstance(part, FunctionType):
        held = tuple(_made_of(cell.cell_contents) for cell in part.__closure__ or ())
        return part.__module__, part.__qualname__, _made_of(part.__code__), held
    if isinstance(part, CodeType):
        return part.co_code, part.co_names, tuple(map(_made_of, part.co_consts))
    return _made_of(part.py_func) if hasattr(part, "py_func") else repr(part)
