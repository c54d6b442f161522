"""Study of joints and blocks that deform: contact points, blocks in a wall, and in a column that is bent."""

from __future__ import annotations

from studies.deformable import bending, lumped, points
from studies.study import SectionedStudy

SECTIONS = (points, lumped, bending)
STUDY = SectionedStudy("deformable", "Joints and blocks that deform", SECTIONS, final=("ok", "completed"))
