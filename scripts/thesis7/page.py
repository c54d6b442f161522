"""The page of chapter 7: its sections and what it says first."""

from __future__ import annotations

from sectioned import Page

HEAD = """\
# Thesis chapter 7: joints that are not plane

Written by `scripts/chapter7 --write` from `docs/chapter7.json`; do not edit. Cases are those of `cases/validation/`;
the numbers of the thesis and the closed forms come from the data book (`tests/reference/`), which names their places.
A profile is geometry: the corners of the polygon are contact points with gaps, and the ordinary law does the rest
(`dem_cli/kernels/planar_profiles.py`). Seconds are those of solving, beside what else the
machine did.
"""

PAGE = Page(
    "chapter7",
    "thesis7",
    ("block", "shapes", "heights", "walls", "softening", "band"),
    HEAD,
    final=("ok", "fails on the way", "does not stand", "no failure"),
)
