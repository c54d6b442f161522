"""Study of thesis chapter 7: its sections."""

from __future__ import annotations

from studies.chapter7 import band, block, heights, shapes, softening, walls
from studies.study import SectionedStudy

STUDY = SectionedStudy(
    "chapter7",
    "Thesis chapter 7, joints that are not plane",
    (block, shapes, heights, walls, softening, band),
    final=("ok", "fails on the way", "does not stand", "no failure"),
)
