"""The page of the church: its sections and what it says first."""

from __future__ import annotations

from sectioned import Page

HEAD = """\
# Thesis Appendix A: a slice of a church

Written by `scripts/church --write` from `docs/church.json`; do not edit. A bay of S. Maria Maggiore in Tuscania,
pushed out of the plane of its walls by λ times all weights; numbers of the thesis are those of the data book
(`tests/reference/thesis_church.toml`). All lengths of the appendix are lost with its figures: what is inferred here,
by which rule, stands in `scripts/churches/geometry.py` and in the case files, which are written from it
(`scripts/church --cases`). Nothing here can be more than a check of the order of loads and of the kind of mechanism.
"""

PAGE = Page("church", "churches", ("walls", "models", "moved", "inferred"), HEAD)
