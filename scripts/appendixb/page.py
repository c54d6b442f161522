"""The page of Appendix B: its sections and what it says first."""

from __future__ import annotations

from sectioned import Page

HEAD = """\
# Thesis Appendix B: walls with loads on top

Written by `scripts/appendix_b --write` from `docs/appendix_b.json`; do not edit. Walls of 0.4 x 0.595 m of dry tuff
bricks on a tilting table: brick ratios b/h of 4.6 (stretchers), 2.3 (headers) and 1 (computed only), conditions A
(self weight), B (five loads), C (loads on a beam) and D (one load off centre on the beam). All runs are one sweep:

```
dem sweep cases/validation/appendix_b.toml -o results/appendix_b --keep all
```

Numbers of the thesis are those of the data book (`tests/reference/thesis_appendix_b.toml`). Its figures are lost,
and with them the places of the loads: heights (0.659 m) and the arm of load D (0.370 m from the toe) were inferred
there from the thesis's rigid-body loads of 0.33 and 0.57, so those two are no predictions. Nothing was fitted to a
DEM or test result.
"""

PAGE = Page("appendix_b", "appendixb", ("tests", "inferred"), HEAD)
