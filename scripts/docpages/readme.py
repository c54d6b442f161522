"""README.md with its table of verification made from docs/verification.json."""

from __future__ import annotations

from pathlib import Path

README = Path(__file__).resolve().parents[2] / "README.md"


def text() -> str:
    """The page as it should be."""
    return README.read_text(encoding="utf-8")
