"""docs/gallery.md from docs/gallery/gallery.toml: pictures with the case and the command that made them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from studies.places import DOCS

WIDTH, INDENT = 84, "    "
INTRODUCTION = """# Gallery

Every picture is drawn by the program from the case and by the commands below it; nothing is retouched.
"""


def text() -> str:
    """The whole page."""
    path = DOCS / "gallery" / "gallery.toml"
    pictures = tomllib.loads(path.read_text(encoding="utf-8"))["picture"] if path.exists() else []
    parts = [INTRODUCTION, *map(section, pictures)]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def section(picture: dict) -> str:
    """Heading, picture, caption, how it was made."""
    commands = picture["command"] if isinstance(picture["command"], list) else [picture["command"]]
    return "\n\n".join(
        [
            f"## {picture['title']}",
            f"![{picture['title']}](gallery/{Path(picture['picture']).name})",
            picture["caption"].strip(),
            "```bash\n" + "\n".join(map(folded, commands)) + "\n```",
        ]
    )


def folded(command: str) -> str:
    """A command on as many lines as it needs, broken before options."""
    lines = [""]
    for part in re.split(r" (?=-)", command):
        if lines[-1] and len(lines[-1]) + 1 + len(part) > WIDTH:
            lines.append(INDENT + part)
        else:
            lines[-1] += f" {part}" if lines[-1] else part
    return " \\\n".join(lines)
