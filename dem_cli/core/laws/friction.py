"""Friction of a joint, as a coefficient or as an angle; common to all laws that have one."""

from __future__ import annotations

import math

from dem_cli.core.laws.stiffness import StiffJoint
from dem_cli.declarations import parameter


class FrictionJoint(StiffJoint):
    """Joint table with stiffness and friction, common to laws that have friction."""

    friction: float | None = parameter(
        default=None, ge=0.0, le=1000.0, description="friction coefficient tan(φ) [-]", examples=[0.6]
    )
    friction_angle_deg: float | None = parameter(
        default=None, ge=0.0, lt=90.0, description="friction angle φ [deg], instead of friction", examples=[31.0]
    )

    variation: float = parameter(
        default=0.0,
        ge=0.0,
        le=1.0,
        description="coefficient of variation of the friction from joint to joint [-]: the joint of each two blocks "
        "has its own, drawn log-normally with the given mean from `seed` and the names of the blocks; residual and "
        "dynamic friction go along",
        examples=[0.15],
    )

    def check(self) -> None:
        """Check that friction is given once, as a coefficient or as an angle."""
        super().check()
        if (self.friction is None) == (self.friction_angle_deg is None):
            given = "both are given" if self.friction is not None else "none is given"
            raise ValueError(f"give either 'friction' or 'friction_angle_deg' ({given})")

    @property
    def coefficient(self) -> float:
        """Friction coefficient tan(φ) [-]."""
        if self.friction_angle_deg is not None:
            return math.tan(math.radians(self.friction_angle_deg))
        assert self.friction is not None
        return self.friction
