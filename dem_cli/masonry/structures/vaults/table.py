"""Table of kind = "vault": barrels, groin (cross) and cloister (domical) vaults over a bay, domes."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from dem_cli.case.base import KeyProblem, NonNegative, Positive, StructureBase, check_count
from dem_cli.masonry.structures.arch import Pier

Count = Annotated[int, Field(ge=3, le=10_000)]

OF_SHAPE = {  # keys that not every shape has: those needed, those that may be given
    "barrel": (("span", "length", "voussoirs"), ("rise", "included_angle_deg", "rows", "offset", "piers")),
    "groin": (("span", "voussoirs"), ("length", "rise", "included_angle_deg", "rows", "groins", "piers")),
    "cloister": (("span", "voussoirs"), ("length", "rise", "included_angle_deg", "rows", "groins", "piers")),
    "dome": (
        ("radius", "courses", "per_course"),
        ("facets", "bond", "springing_deg", "oculus_deg", "oculus_radius", "cap", "drum"),
    ),
}


class Vault(StructureBase):
    """Vault of cut stones in 3D. Local origin: in the middle of its plan, at the level where the inner face starts,
    with piers or a drum on the ground below them.

    Block names: of a barrel "<id>-<voussoir>-<number>", voussoirs from left to right as in an arch, numbers along it
    from the front; "<id>-left-<course>-<number>", "<id>-right-..." for its walls. Of a groin vault
    "<id>-south-<voussoir>-<number>" and so on for the webs, "<id>-sw-<voussoir>" for stones astride the groin of a
    corner, "<id>-boss" where all groins meet, "<id>-sw-pier-<number>". Of a cloister vault
    "<id>-south-<course>-<number>" and so on, courses from the springing up, "<id>-sw-<course>" at its corners,
    "<id>-boss"; "<id>-south-wall-<course>-<number>" and "<id>-sw-wall-<course>". Of a dome "<id>-<course>-<number>",
    numbers counter-clockwise from x, "<id>-cap", "<id>-drum-<course>-<number>". Fixed: "<id>-base-left",
    "<id>-base-sw", "<id>-base-south", "<id>-base-<number>".
    """

    only_in: ClassVar[int | None] = 3

    kind: Literal["vault"] = "vault"
    shape: Literal["barrel", "groin", "cloister", "dome"] = Field(
        description="barrel: a tunnel; groin: two barrels that cross over a bay; cloister: four webs that rise from "
        "the sides of a bay; dome: part of a sphere",
        examples=["dome"],
    )
    thickness: Positive = Field(description="of the shell, from inner to outer face [m]", examples=[0.3])
    span: Positive | None = Field(None, description="clear span along x [m] (barrel, groin, cloister)", examples=[4.0])
    length: Positive | None = Field(
        None,
        description="of a barrel, along y; clear span along y over a bay, default: span [m]",
        examples=[6.0],
    )
    rise: Positive | None = Field(
        None,
        description="rise of the inner face [m] (barrel, groin, cloister); more than half the span: pointed; default: "
        "a semicircle",
        examples=[1.0],
    )
    included_angle_deg: float | None = Field(
        None,
        gt=0.0,
        le=180.0,
        description="from springing to springing [deg], instead of rise (barrel, groin, cloister)",
        examples=[120.0],
    )
    voussoirs: int | None = Field(
        None, ge=2, le=10_000, description="number of voussoirs over the span (barrel, groin, cloister)", examples=[15]
    )
    rows: int = Field(
        1, ge=1, le=10_000, description="number of stones along a whole course (barrel, groin, cloister)", examples=[8]
    )
    offset: NonNegative | None = Field(
        None,
        description="shift of the heads of every other course [m] (barrel); 0: rings side by side; default: half a "
        "stone",
        examples=[0.0],
    )
    groins: Literal["astride", "mitred"] = Field(
        "astride",
        description="astride: one stone turns the corner from web to web; mitred: a joint in the plane of the groin "
        "(groin, cloister)",
    )
    piers: Pier | None = Field(
        None,
        description="below the springings: walls along a barrel, around a cloister vault, square piers at the corners "
        "of a groin vault",
        examples=[{"width": 0.6, "height": 2.5, "courses": 6}],
    )
    radius: Positive | None = Field(
        None, description="of the middle of the shell, where its facets meet [m] (dome)", examples=[5.0]
    )
    courses: int | None = Field(None, ge=1, le=10_000, description="number of courses (dome)", examples=[12])
    per_course: Count | tuple[Count, ...] | None = Field(
        None,
        description="number of stones in each course, one for all or from the springing up (dome)",
        examples=[24, [24, 24, 12, 12]],
    )
    facets: Count | None = Field(
        None,
        description="plane facets around, a multiple of every per_course (dome); default: two for the smallest stone, "
        "one with bond = 'stack'",
        examples=[48],
    )
    bond: Literal["running", "stack"] = Field(
        "running", description="running: heads of a course lie above the middle of stones; stack: above heads (dome)"
    )
    springing_deg: float = Field(
        90.0, gt=0.0, le=90.0, description="where it springs, from the crown; 90: a hemisphere [deg] (dome)"
    )
    oculus_deg: float | None = Field(
        None, gt=0.0, lt=90.0, description="where it ends below the crown [deg] (dome)", examples=[10.0]
    )
    oculus_radius: Positive | None = Field(
        None, description="clear radius of its opening [m], instead of oculus_deg (dome)", examples=[0.6]
    )
    cap: bool | None = Field(
        None,
        description="whether one stone closes it at the crown (dome); default: where no oculus is given",
        examples=[False],
    )
    drum: Pier | None = Field(
        None, description="an upright wall below the dome", examples=[{"width": 0.8, "height": 2.0, "courses": 4}]
    )
    base: bool = Field(True, description="fixed blocks below, as deep as the vault is thick")

    @model_validator(mode="after")
    def _countable(self) -> Vault:
        per_course = self.per_course if isinstance(self.per_course, int) else max(self.per_course or (1,))
        check_count((self.voussoirs or 1) * self.rows, "voussoirs")
        check_count((self.courses or 1) * per_course, "courses")
        return self

    @property
    def on_ground(self) -> bool:
        """Tell whether a [ground] block replaces the base of piers or a drum; bare springings stay fixed."""
        return self.piers is not None or self.drum is not None

    @model_validator(mode="after")
    def _keys_of_its_shape(self) -> Vault:
        needed, other = OF_SHAPE[self.shape]
        for key in sorted({key for pair in OF_SHAPE.values() for keys in pair for key in keys} - {*needed, *other}):
            if key in self.model_fields_set:
                raise KeyProblem(f"not used by a {self.shape}, which has {', '.join((*needed, *other))}", key)
        for key in needed:
            if getattr(self, key) is None:
                raise KeyProblem(f"missing: a {self.shape} needs {', '.join(needed)}", key)
        for one, two in (("rise", "included_angle_deg"), ("oculus_deg", "oculus_radius")):
            if getattr(self, one) is not None and getattr(self, two) is not None:
                raise KeyProblem(f"{one} and {two} say the same; give one of them", two)
        return self
