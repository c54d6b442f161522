"""Stiffness and contact points of a joint, common to all laws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem
from dem_cli.laws.profile import Profile

ELASTIC = 3  # points along a line, from which on it is as stiff in bending as it is
Stiffness = Literal["auto"] | Annotated[float, Field(gt=0.0)]


class StiffJoint(CaseModel):
    """Normal and shear stiffness of a joint per unit area, its profile or the number of its contact points."""

    plane_points: ClassVar[int] = 2  # contact points of a plane joint that says nothing else
    area_points: ClassVar[int] = 2  # and in 3D along each side of its area; 2: its vertices

    if TYPE_CHECKING:
        law: str  # each law's own table declares it, with its name as the only value

    kn: Stiffness = Field(
        default="auto", description="normal stiffness [Pa/m], or 'auto': stiff enough to drop out", examples=[1e10]
    )
    ks: Stiffness = Field(default="auto", description="shear stiffness [Pa/m], or 'auto': equal to kn", examples=[4e9])
    profile: Profile | None = Field(
        default=None,
        description="shape of contact surfaces that are not plane; default: plane",
        examples=[{"sides": 3, "aperture": 1e-4}],
    )
    points: Annotated[int, Field(ge=2, le=9)] | Literal["vertices", "vertices+centre"] | None = Field(
        default=None,
        description="contact points of a plane joint: so many, at Gauss-Lobatto places; in 3D so many along each side "
        "of the area of contact, or at its vertices alone, or at its centre as well; default: 2; 5 where the joint can "
        "crack, 3 where it is elastic; in 3D 3 by 3 there and where kn is given, else the vertices",
        examples=[5],
    )

    @model_validator(mode="after")
    def _points_of_plane_joints(self) -> StiffJoint:
        if self.profile is not None and self.points is not None:
            raise KeyProblem("not allowed with 'profile': its vertices are the contact points", "points")
        return self

    def contact_points(self, dimension: int) -> int:
        """Number of contact points of a plane joint in 2D; in 3D along each side of its area, where 2 are its vertices.

        Joints whose bending stiffness or strength is a property have as many as it takes.
        """
        if self.points is not None:
            return self.points if isinstance(self.points, int) else 2
        if dimension == 2:
            return self.plane_points
        return max(self.area_points, 2 if self.kn == "auto" else ELASTIC)

    @property
    def centred(self) -> bool:
        """Whether contact points are the vertices and the centre of the area."""
        return self.points == "vertices+centre"
