"""docs/gallery.md from docs/gallery/gallery.toml: pictures with the case and the command that made them."""

from __future__ import annotations

import tomllib
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
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
            "```bash\n" + "\n".join(commands) + "\n```",
        ]
    )
