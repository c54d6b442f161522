"""Writes docs/laws: one page and one picture per joint law, from the laws themselves."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
for folder in (ROOT, ROOT / "scripts"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))


def main(words: Sequence[str] | None = None) -> int:
    """0 always."""
    parser = argparse.ArgumentParser(prog="scripts/laws", description=__doc__)
    parser.add_argument("--text", action="store_true", help="pages only, no pictures")
    options = parser.parse_args(words)

    from lawpages.draw import draw
    from lawpages.page import index, text
    from lawpages.pages import PAGES

    folder = ROOT / "docs" / "laws"
    folder.mkdir(exist_ok=True)
    for page in PAGES:
        (folder / f"{page.name}.md").write_text(text(page), encoding="utf-8")
        if not options.text:
            draw(page, folder / f"{page.name}.png")
    (folder / "README.md").write_text(index(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
