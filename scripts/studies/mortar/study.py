"""Study of mortar joints in space."""

from __future__ import annotations

from studies.mortar import cycles, joints, pressure_wall, settlement, wallettes
from studies.study import SectionedStudy

PARTS = (joints, wallettes, pressure_wall, settlement, cycles)
STUDY = SectionedStudy(
    "mortar", "Joints of mortar: plates out of plane, walls under pressure, settlement, cycles", PARTS
)
