"""Study of mortar joints in space."""

from __future__ import annotations

from studies.mortar import joints, wallettes
from studies.study import SectionedStudy

STUDY = SectionedStudy("mortar", "Mortar joints in bending out of the plane of a wall", (joints, wallettes))
