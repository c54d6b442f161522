"""Table [damping] of time histories: energy dissipation of joints and blocks, beside friction."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Positive
from dem_cli.core.records.requests import DEFAULT_FRACTION

JOINTS = ("contact_fraction", "restitution", "rayleigh", "stiffness")  # each sets the dashpots: one of them


class RayleighDamping(CaseModel):
    """damping.rayleigh: damping ratio of elastic modes, c = a0 m + a1 k."""

    ratio: Annotated[float, Field(gt=0.0, lt=1.0)] = Field(
        description="damping ratio at the given frequencies [-]", examples=[0.02]
    )
    frequency: Positive | None = Field(
        default=None, description="where the ratio holds [Hz]; with both parts it is least there", examples=[10.0]
    )
    frequencies: tuple[Positive, Positive] | None = Field(
        default=None,
        description="instead of frequency: two between which the ratio is at most the given one [Hz]",
        examples=[[2.0, 20.0]],
    )
    mass: bool | None = Field(
        default=None,
        description="with the part that is proportional to mass, which brakes blocks that rock, slide or fall as well; "
        "default: only with two frequencies, which need it, and where stiffness = false",
        examples=[True],
    )
    stiffness: bool = Field(default=True, description="with the part that is proportional to stiffness")

    @model_validator(mode="after")
    def _frequencies_and_parts(self) -> RayleighDamping:
        if (self.frequency is None) == (self.frequencies is None):
            both = "'frequency' and 'frequencies' are"
            found = both if self.frequency else "neither 'frequency' nor 'frequencies' is"
            raise ValueError(f"{found} given; one of them says where the ratio holds")
        if not (self.of_mass or self.stiffness):
            raise KeyProblem("false is not allowed where mass = false too: nothing would be damped", "stiffness")
        if self.frequencies is not None and not self.frequencies[0] < self.frequencies[1]:
            raise KeyProblem(f"{self.frequencies[1]:g} is not allowed; must be more than the first", "frequencies", 1)
        if self.frequencies is not None and not (self.of_mass and self.stiffness):
            raise KeyProblem("two frequencies need both parts; one part alone needs 'frequency'", "frequencies")
        return self

    @property
    def of_mass(self) -> bool:
        """Tell whether Rayleigh damping has a part proportional to mass."""
        return self.frequencies is not None or not self.stiffness if self.mass is None else self.mass

    def coefficients(self) -> tuple[float, float]:
        """Rayleigh coefficients a0 [1/s] of mass and a1 [s] of stiffness (Clough and Penzien, ch. 12)."""
        if self.frequencies is not None:
            low, high = (2.0 * math.pi * f for f in self.frequencies)
            return 2.0 * self.ratio * low * high / (low + high), 2.0 * self.ratio / (low + high)
        assert self.frequency is not None
        omega = 2.0 * math.pi * self.frequency
        share = 1.0 if self.of_mass and self.stiffness else 2.0
        return share * self.ratio * omega * self.of_mass, share * self.ratio / omega * self.stiffness


class MaxwellElement(CaseModel):
    """damping.maxwell: a spring and a dashpot in series beside each spring of a joint."""

    ratio: Annotated[float, Field(gt=0.0, lt=0.5)] = Field(
        description="damping ratio that it gives at its frequency [-]", examples=[0.03]
    )
    frequency: Positive = Field(description="where it damps most [Hz]", examples=[5.0])


class DampingTable(CaseModel):
    """[damping]: joints have at most one of contact_fraction, restitution, rayleigh and stiffness."""

    contact_fraction: Annotated[float, Field(ge=0.0, le=10.0)] | None = Field(
        default=None,
        description="dashpots of the joints as a fraction of critical at the frequency of a block on its joint [-]; "
        f"{DEFAULT_FRACTION} without a [damping] table",
        examples=[DEFAULT_FRACTION],
    )
    restitution: Annotated[float, Field(gt=0.0, lt=1.0)] | Literal["housner"] | None = Field(
        default=None,
        description="wanted ratio of angular velocities after and before a rocking block lands [-]",
        examples=["housner"],
    )
    block: str | None = Field(
        default=None,
        description="id of the block whose frequency or restitution is meant; default: each joint for itself, "
        "and the heaviest block with a face on a support for a restitution",
        examples=["column-1"],
    )
    rayleigh: RayleighDamping | None = Field(
        default=None,
        description="damping ratio of elastic modes: { ratio, frequency or frequencies, mass, stiffness }",
        examples=[{"ratio": 0.02, "frequency": 10.0}],
    )
    stiffness: Positive | None = Field(
        default=None, description="damping over stiffness of all joints [s]", examples=[1e-4]
    )
    mass: Positive | None = Field(
        default=None, description="damping force over mass and velocity of blocks [1/s]", examples=[0.5]
    )
    maxwell: Annotated[tuple[MaxwellElement, ...], Field(min_length=1)] | None = Field(
        default=None,
        description="elements beside each spring: [{ ratio, frequency }]",
        examples=[[{"ratio": 0.03, "frequency": 5.0}]],
    )
    local: Annotated[float, Field(gt=0.0, lt=1.0)] | None = Field(
        default=None,
        description="share of the unbalanced force against the motion [-]; has no physical meaning",
        examples=[0.1],
    )
    none: bool = Field(default=False, description="true: no damping but friction")

    @model_validator(mode="after")
    def _one_choice_for_joints(self) -> DampingTable:
        given = [name for name in JOINTS if getattr(self, name) is not None]
        if len(given) > 1:
            raise KeyProblem(f"not beside {given[0]}: joints have one of {', '.join(JOINTS)}", given[1])
        others = [*given, *(name for name in ("mass", "maxwell", "local") if getattr(self, name) is not None)]
        if self.none and others:
            raise KeyProblem(f"true is not allowed beside {others[0]}", "none")
        if not (self.none or others):
            raise ValueError(f"nothing is given; one of {', '.join(JOINTS)}, mass, maxwell, local, or none = true")
        if self.mass is not None and self.rayleigh is not None and self.rayleigh.of_mass:
            raise KeyProblem("not beside rayleigh, which has a part of mass already", "mass")
        if self.block is not None and self.contact_fraction is None and self.restitution is None:
            raise KeyProblem("needs contact_fraction or restitution, which are those of a block", "block")
        return self
