"""Study of the gallery: draws the pictures of docs/gallery/gallery.toml with the commands that stand beside them.

A command that several pictures share is run once. Afterwards each picture has to be there, and small.
"""

from __future__ import annotations

import argparse
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from functools import cache
from typing import Any

from studies.places import DOCS, ROOT
from studies.study import StudyRunner

FOLDER = DOCS / "gallery"
LARGEST = {".png": 200_000, ".gif": 600_000}  # bytes


def pictures() -> list[dict[str, Any]]:
    """All entries of the list."""
    return tomllib.loads((FOLDER / "gallery.toml").read_text(encoding="utf-8"))["picture"]


def commands(picture: dict[str, Any]) -> list[str]:
    """What makes a picture, in order."""
    return picture["command"] if isinstance(picture["command"], list) else [picture["command"]]


@cache
def run(command: str) -> None:
    """One command line of `dem`, in the root of the project, once. Raises CalledProcessError."""
    program, *words = shlex.split(command)
    assert program == "dem", command
    print(f"$ {command}", flush=True)
    subprocess.run([sys.executable, "-m", "dem_cli", *words], cwd=ROOT, check=True)


class GalleryStudy(StudyRunner):
    """One section per picture, which its commands write."""

    parts, solves = "PICTURE", False

    def measure(self, section: str, options: argparse.Namespace) -> None:
        for command in commands(self.sections[section]):
            run(command)

    def said(self, section: str, found: Any) -> str:
        return f"docs/gallery/{section}: {(FOLDER / section).stat().st_size:,} bytes"

    def problems(self, section: str, found: Any) -> list[str]:
        path = FOLDER / section
        size, most = path.stat().st_size, LARGEST[path.suffix]
        return [f"{section}: {size:,} bytes, at most {most:,}"] if size > most else []

    def write(self, found: Mapping[str, Any]) -> None:
        """Pictures are written by their commands."""

    def redraw(self) -> None:
        """Nothing is kept to draw from."""


STUDY = GalleryStudy("gallery", "Draw the pictures of docs/gallery.md", {one["picture"]: one for one in pictures()})
