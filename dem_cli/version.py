"""Version of dem, and the command that installs its optional parts; docs/versions.md says what a version promises."""

from __future__ import annotations

from pathlib import Path

__version__ = "0.23.0"
NAME = "dem-cli"  # of the distribution, which no index has: it comes from a checkout
_HERE = Path(__file__).resolve().parent.parent


def install_command(extra: str) -> str:
    """Return the command that installs an optional part of dem: `pip install '/home/me/dem[plot]'`."""
    checkout = _checkout()
    if checkout is None:
        return f"pip install '.[{extra}]' in the folder of dem"
    import shlex

    return f"pip install {shlex.quote(f'{checkout}[{extra}]')}"


def _checkout() -> Path | None:
    """Find the folder that dem runs in or was installed from; None where it is gone."""
    import json
    from importlib.metadata import PackageNotFoundError, distribution
    from urllib.parse import urlparse
    from urllib.request import url2pathname

    if (_HERE / "pyproject.toml").is_file():
        return _HERE
    try:
        origin = json.loads(distribution(NAME).read_text("direct_url.json") or "{}").get("url", "")
    except (PackageNotFoundError, ValueError):
        return None
    path = Path(url2pathname(urlparse(origin).path)) if origin.startswith("file:") else None
    return path if path is not None and (path / "pyproject.toml").is_file() else None
