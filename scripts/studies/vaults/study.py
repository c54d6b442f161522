"""Study of vaults in space."""

from __future__ import annotations

from studies.study import SectionedStudy
from studies.vaults import axle, hoops, thickness, thrust

STUDY = SectionedStudy(
    "vaults", "Vaults in space against closed forms and limit analysis", (thickness, hoops, thrust, axle)
)
