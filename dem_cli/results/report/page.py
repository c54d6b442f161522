"""HTML page of a report: template, style sheet and scripts in one file, closed to the network.

The policy in its head lets the browser run the scripts of this file by their hashes, show pictures that are in it, and
load nothing else.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from dem_cli.input_limits import CASE_BYTES, UnreadableInput, read_bounded
from dem_cli.results.output.scalars import plain

ASSETS = Path(__file__).parent / "assets"
TEMPLATE, STYLE_SHEET, THREE = "page.html", "page.css", "three.min.js"
SCRIPTS = ("chart.js", "scene.js", "section.js", "marks.js", "eye.js", "player.js", "table.js", "main.js")


def render(data: Mapping[str, Any], **shown: Any) -> str:
    """Render the page as text. data: for the scripts, view, charts or runs; shown: for the template.

    brief=True leaves the head and the view, for a cell of a notebook.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    libraries = [asset(THREE)] if data.get("view") else []
    scripts = [*libraries, "".join(["'use strict';\n", *map(asset, SCRIPTS)])]
    templates = Environment(
        loader=FileSystemLoader(ASSETS),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    text: str = templates.get_template(TEMPLATE).render(
        policy=policy(scripts, [asset(STYLE_SHEET)]),
        style=asset(STYLE_SHEET),
        scripts=scripts,
        data=script_json(data),
        **({"brief": False} | shown),
    )
    return text


def script_json(data: Mapping[str, Any]) -> str:
    """Encode JSON that no text in it can end the script element early; non-finite numbers become null."""
    text = json.dumps(plain(data), ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def policy(scripts: Iterable[str], styles: Iterable[str]) -> str:
    """Create the Content-Security-Policy: these scripts and styles, pictures inside the file, nothing from
    elsewhere.
    """
    return "; ".join((
        "default-src 'none'",
        f"script-src {' '.join(map(_hash, scripts))}",
        f"style-src {' '.join(map(_hash, styles))}",
        "img-src data:",
        "base-uri 'none'",
        "form-action 'none'",
    ))  # fmt: skip


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@cache
def asset(name: str) -> str:
    """Read a file of this package."""
    return (ASSETS / name).read_text(encoding="utf-8")


def case_text(path: Path) -> str:
    """Read the case beside the results, as far as possible; "" where it is gone."""
    try:
        return read_bounded(path, CASE_BYTES).decode("utf-8", errors="replace")
    except (OSError, UnreadableInput):
        return ""
