"""Study of thesis chapter 6: its sections."""

from __future__ import annotations

from studies.chapter6 import arch, blocks, column, engines, near_collapse, records
from studies.study import SectionedStudy

STUDY = SectionedStudy(
    "chapter6",
    "Thesis chapter 6, shaken blocks, column and arch",
    (blocks, column, arch, engines, records, near_collapse),
)
