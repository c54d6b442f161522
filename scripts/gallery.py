"""Draws the pictures of docs/gallery/gallery.toml with the commands that stand beside them.

A command that several pictures share is run once. Afterwards each picture has to be there, and small.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
GALLERY = ROOT / "docs" / "gallery"
LARGEST = {".png": 200_000, ".gif": 600_000}  # bytes


def pictures() -> list[dict]:
    """All entries of the list."""
    return tomllib.loads((GALLERY / "gallery.toml").read_text(encoding="utf-8"))["picture"]


def commands(picture: dict) -> list[str]:
    """What makes a picture, in order."""
    return picture["command"] if isinstance(picture["command"], list) else [picture["command"]]


def run(command: str) -> None:
    """One command line of `dem`, in the root of the project. Raises CalledProcessError."""
    program, *words = shlex.split(command)
    assert program == "dem", command
    print(f"$ {command}", flush=True)
    subprocess.run([sys.executable, "-m", "dem_cli", *words], cwd=ROOT, check=True)


def too_large(picture: dict) -> str:
    """What is wrong with a picture that was drawn; empty where nothing is."""
    path = GALLERY / picture["picture"]
    size = path.stat().st_size
    return f"{path.name}: {size:,} bytes, at most {LARGEST[path.suffix]:,}" if size > LARGEST[path.suffix] else ""


def main(names: Sequence[str]) -> int:
    """0 where all pictures were drawn and are small enough."""
    chosen = [picture for picture in pictures() if not names or picture["picture"] in names]
    unknown = set(names) - {picture["picture"] for picture in chosen}
    if unknown:
        print(f"not in gallery.toml: {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    done: set[str] = set()
    for picture in chosen:
        for command in commands(picture):
            if command not in done:
                run(command)
                done.add(command)
    wrong = list(filter(None, map(too_large, chosen)))
    print("\n".join(wrong), file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
