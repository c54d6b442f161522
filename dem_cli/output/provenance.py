"""Provenance of a result: the versions that it was computed with. Nothing here names a machine, a person or a place."""

from __future__ import annotations

import platform
from functools import cache
from importlib import metadata

from dem_cli.version import __version__

PACKAGES = ("numpy", "numba", "scipy", "clarabel", "h5py", "pydantic")


def provenance() -> dict[str, str]:
    """Versions by name; packages that are not installed are left out."""
    return dict(_versions())


@cache
def _versions() -> dict[str, str]:
    """Looked up once in a process: it reads files."""
    versions = {"dem": __version__, "python": platform.python_version(), "machine": platform.machine()}
    for name in PACKAGES:
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return versions
