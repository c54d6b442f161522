"""Study of thesis Appendix B: its sections."""

from __future__ import annotations

from studies.appendix_b import failure_loads, sensitivity, softness
from studies.study import SectionedStudy

STUDY = SectionedStudy("appendix_b", "Thesis Appendix B, walls with top load", (softness, failure_loads, sensitivity))
