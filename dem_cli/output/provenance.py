"""Provenance of a result: the versions that it was computed with. Nothing here names a machine, a person or a place."""

from __future__ import annotations

import platform
import re
from functools import cache
from importlib import metadata

from dem_cli.version import __version__

PACKAGES = ("numpy", "numba", "scipy", "clarabel", "h5py", "pydantic")
_VERSION = re.compile(r"^Version: *(\S+)", re.MULTILINE)


def provenance() -> dict[str, str]:
    """Versions by name; packages that are not installed are left out."""
    return dict(_versions())


@cache
def _versions() -> dict[str, str]:
    """Looked up once in a process: it reads files."""
    versions = {"dem": __version__, "python": platform.python_version(), "machine": platform.machine()}
    for name in PACKAGES:
        try:
            versions[name] = _version_of(name)
        except metadata.PackageNotFoundError:
            continue
    return versions


def _version_of(package: str) -> str:
    """As `metadata.version`, which reads what a package says of itself as an e-mail, 5 ms each."""
    said = _VERSION.search(metadata.distribution(package).read_text("METADATA") or "")
    return said[1] if said else metadata.version(package)
