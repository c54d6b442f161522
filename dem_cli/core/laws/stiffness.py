"""Stiffness and contact points of a joint, common to all laws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from dem_cli.core.laws.profile import Profile
from dem_cli.declarations import KeyProblem, Limits, Name, Parameters, Positive, parameter

# Contact points of a plane joint whose stiffness is a property but is not integrated, by dimension; in 3D along each
# side. With points at its ends or vertices alone its moment is three times too stiff (docs/deformable.md).
BENDING_POINTS = {2: 5, 3: 3}
SECTION = 16  # that with which a joint is as strong as its whole section: contact/layout.py, and there SECTION as well
AREA_POINTS = {"vertices": 2, "vertices+centre": 3}  # in 3D; in 2D as stiff in bending
Stiffness = Literal["auto"] | Positive


class StiffJoint(Parameters):
    """Normal and shear stiffness of a joint per unit area, its profile or the number of its contact points."""

    integrable: ClassVar[bool] = True  # carries no tension, and gives back all work across the joint
    # Contact points of a plane joint so stiff that its stiffness drops out; in 3D 3 to 5: with its centre.
    plane_points: ClassVar[int] = 2

    if TYPE_CHECKING:
        law: str  # each law's own table declares it, with its name as the only value

    kn: Stiffness = parameter(
        default="auto", description="normal stiffness [Pa/m], or 'auto': stiff enough to drop out", examples=[1e10]
    )
    ks: Stiffness = parameter(
        default="auto", description="shear stiffness [Pa/m], or 'auto': equal to kn", examples=[4e9]
    )
    profile: Profile | None = parameter(
        default=None,
        description="shape of contact surfaces that are not plane; default: plane",
        examples=[{"sides": 3, "aperture": 1e-4}],
    )
    points: Annotated[int, Limits(ge=2, le=9)] | Literal["vertices", "vertices+centre", "section"] | None = parameter(
        default=None,
        description="contact points of a plane joint: so many, at Gauss-Lobatto places; in 3D so many along each side "
        "of the area of contact, or at its vertices alone, or at its centre as well; section: 16, in 3D 57, with "
        "which a joint that cracks or is crushed is as strong in bending as its whole section; default: section where "
        "the joint has tension, cohesion or compression, but for time histories; else 2, in 3D vertices, with the "
        "pressure integrated over the closed part where kn is given or blocks deform (materials.NAME.young); in time "
        "histories with tension or cohesion 5, and where it is elastic 3, in 3D vertices+centre",
        examples=[5],
    )

    head: Name | None = parameter(
        default=None,
        description="the joint, by its name in [joints], between blocks side by side in one course; 'none': such head "
        "joints are not filled, and nothing acts between these blocks however they move; default: like all others",
        examples=["perpend"],
    )

    def check(self) -> None:
        """Check that contact points are given for plane joints only, not beside a profile."""
        super().check()
        if self.profile is not None and self.points is not None:
            raise KeyProblem("not allowed with 'profile': its vertices are the contact points", "points")

    @property
    def asks_for_points(self) -> bool:
        """True where the input says where the contact points of the joint are."""
        return self.profile is not None or self.points is not None

    @property
    def integrates(self) -> bool:
        """True where the pressure on an elastic face is integrated over the face."""
        return self.integrable and not self.asks_for_points

    @property
    def cracks(self) -> bool:
        """True where the joint cracks or is crushed bit by bit: it has SECTION points then, but in time histories."""
        return False

    @property
    def bends(self) -> bool:
        """True where the joint opens bit by bit, and has BENDING_POINTS where its stiffness is a property."""
        return not self.cracks

    def sectional(self, lands: bool = False) -> bool:
        """Test whether the joint has the points that give the strength of its whole section. lands: as in `follows`."""
        return self.points == "section" or (self.cracks and not self.asks_for_points and not lands)

    def follows(self, deforms: bool = False, lands: bool = False) -> bool:
        """Test whether the contact points of the joint are those that its bending stiffness needs.

        Not where blocks land on each other: points between the ends take part of the blow, and a block that rocks loses
        less than Housner's. deforms: whether the joint carries the deformation of blocks; lands: whether the analysis
        is a time history.
        """
        return not self.asks_for_points and self.bends and not lands and (deforms or self.kn != "auto")

    def contact_points(self, dimension: int, deforms: bool = False, lands: bool = False) -> int:
        """Return the number of contact points of a plane joint in 2D; in 3D along each side of its area, where 2 are
        its vertices.

        deforms, lands: as in `follows`.
        """
        if isinstance(self.points, int):
            return self.points
        if self.follows(deforms, lands):
            return BENDING_POINTS[dimension]
        if self.sectional(lands):
            return SECTION
        if dimension == 3:
            return 2
        return self.plane_points if self.points is None else AREA_POINTS[str(self.points)]

    def centred(self, dimension: int, deforms: bool = False, lands: bool = False) -> bool:
        """Test whether the contact points of the joint are the vertices and the centre of its area. deforms, lands: as
        in `follows`.
        """
        asked = self.points == "vertices+centre" or (self.points is None and self.plane_points > 2)
        return asked and dimension == 3 and not self.follows(deforms, lands) and not self.sectional(lands)
