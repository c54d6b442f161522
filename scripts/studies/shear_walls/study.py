"""Study of the dry-stone shear walls SW30 to SW250: capacity curves over the tests."""

from __future__ import annotations

from studies.shear_walls import beam, rigid
from studies.study import SectionedStudy

STUDY = SectionedStudy("shear_walls", "Dry-stone shear walls: capacity curves over their tests", [rigid, beam])
