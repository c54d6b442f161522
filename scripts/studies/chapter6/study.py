"""Study of thesis chapter 6: its sections."""

from __future__ import annotations

from studies.chapter6 import arch, blocks, column, engines, family, near_collapse, records
from studies.study import SectionedStudy

STUDY = SectionedStudy(
    "chapter6",
    "Thesis chapter 6, shaken blocks, column and arch",
    (blocks, column, arch, family, engines, records, near_collapse),
)
