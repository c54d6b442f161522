"""The page of chapter 6: its sections and what it says first."""

from __future__ import annotations

from sectioned import Page

HEAD = """\
# Thesis chapter 6: blocks, a column and an arch that are shaken

Written by `scripts/chapter6 --write` from `docs/chapter6.json`; do not edit. Cases are those of `cases/validation/`;
the numbers of the thesis come from the data book (`tests/reference/thesis_arch_shaking.toml`, `thesis_rocking.toml`),
which names their places. Seconds are CPU seconds of whole runs.

**Inferred, not given**: Figure 6-2, the only drawing of the arch with its sizes, is lost. The data book infers columns
of 0.16 m × 0.32 m from their restitution and from 180 Hz, and six voussoirs with an inner radius of 0.20 m and a ring
of 0.08 m from the static load of 0.325. Every figure on the arch below hangs on that; other geometries with the same
load are shown beside it. Nothing was fitted to what the thesis found under shaking.
"""

PAGE = Page(
    "chapter6",
    "thesis6",
    ("blocks", "column", "arch", "engines", "records", "failure"),
    HEAD,
)
