"""Study of joints and blocks that deform: contact points, blocks lumped into their joints."""

from __future__ import annotations

from studies.deformable import lumped, points
from studies.study import SectionedStudy

STUDY = SectionedStudy("deformable", "Joints and blocks that deform", (points, lumped), final=("ok", "completed"))
