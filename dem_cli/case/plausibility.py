"""Plausibility checks of a case: values that are allowed but look like a slip, most often a wrong unit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from dem_cli.analysis_kinds import kind_of
from dem_cli.case.base import CaseModel
from dem_cli.case.schema import Case
from dem_cli.case.wording import show
from dem_cli.errors import CaseProblem, KeyPath

NO_SLIP = (5.0, 10.0)  # friction coefficients that are written where joints must not slip; and from LOCKED on
LOCKED = 90.0  # no angle in degrees
MANY = 10  # blocks: so many are not as large as one that stands for a whole wall
COARSE = 0.4  # element of a bar times μ: from here on the stiffness of bond is more than 5 % off
VERTICAL = 1e-3  # horizontal share of a direction that counts as none


class UsualRange(NamedTuple):
    """Usual range of a physical quantity, and the units that it may have been given in by mistake."""

    low: float
    high: float
    unit: str
    what: str
    likely: tuple[float, float] = (0.0, 0.0)  # what it is between where it was meant in another unit
    others: Mapping[str, float] = {}  # other units, and one of them in ours

    def doubt(self, value: float, *also: str) -> str | None:
        """Return the warning about an unusual value; None for a usual one. also: other likely meanings."""
        if self.low <= value <= self.high:
            return None
        text = f"{show(value)} {self.unit} is unusual for {self.what}"
        found = {unit: factor * value for unit, factor in self.others.items()}
        meant = [f"{v:.4g} ({show(value)} {u})" for u, v in found.items() if self.likely[0] <= v <= self.likely[1]]
        meant += also
        return f"{text}, did you mean {' or '.join(meant)}?" if meant else text


LENGTHS = {"mm": 1e-3, "cm": 1e-2}
STRENGTH = UsualRange(20.0, 1e10, "Pa", "a joint", (1e3, 1e9), {"MPa": 1e6, "kPa": 1e3})
USUAL = {
    # cork to lead; what is heavier stands for a load, where something usual is beside it
    "density": UsualRange(
        100.0, 12000.0, "kg/m3", "a building material", (400.0, 8000.0),
        {"g/cm3": 1000.0, "kN/m3": 1000.0 / 9.81, "N/m3": 1.0 / 9.81},
    ),
    "gravity": UsualRange(
        0.5, 30.0, "m/s2", "gravity (9.81 on Earth)", (9.0, 10.5), {"mm/s2": 1e-3, "cm/s2": 1e-2}
    ),
    "friction_angle_deg": UsualRange(5.0, 65.0, "deg", "a friction angle", (5.0, 65.0), {"rad": 180.0 / math.pi}),
    "cohesion": STRENGTH,
    "tension": STRENGTH,
    "compression": STRENGTH,
    "jcs": STRENGTH,
    # nylon to carbon fibre
    "young": UsualRange(1e8, 1e12, "Pa", "a tie or bar", (1e9, 1e12), {"GPa": 1e9, "MPa": 1e6}),
    "yield_stress": UsualRange(1e6, 1e10, "Pa", "a tie or bar", (2e7, 5e9), {"MPa": 1e6, "kPa": 1e3}),
    "area": UsualRange(0.0, 0.5, "m2", "the section of a tie or bar", (1e-6, 0.1), {"mm2": 1e-6, "cm2": 1e-4}),
    # a barrel vault; the largest stone ever moved; many blocks of an arch or a wall
    "thickness": UsualRange(0.0, 50.0, "m", "the depth of a structure", (0.02, 5.0), LENGTHS),
    "block": UsualRange(0.0, 20.0, "m", "the size of a block, {root}", (0.02, 5.0), LENGTHS),
    "blocks": UsualRange(0.0, 8.0, "m", "the size of blocks, {root}", (0.02, 5.0), LENGTHS),
}  # fmt: skip
ROOTS = {2: "root of {} area", 3: "cube root of {} volume"}  # dimension -> what the size of a block is
STEEPEST = 2.0  # friction coefficient, tan(63°)


def doubts(case: Case) -> Iterator[CaseProblem]:
    """Yield warnings about a valid case from its tables; `size_doubts` checks its blocks."""
    yield from _material_doubts(case)
    for name, joint in case.joints.items():
        yield from _joint_doubts(joint, ("joints", name))
    if case.gravity == 0.0:
        yield CaseProblem(("gravity",), "0 leaves the blocks without weight")
    elif text := USUAL["gravity"].doubt(case.gravity):
        yield CaseProblem(("gravity",), text)
    for table in () if kind_of(case.analysis.kind).shakes else ("motion", "damping", "initial"):
        if getattr(case, table):
            yield CaseProblem((table,), f"not used: kind = {show(case.analysis.kind)} has no time", at_key=True)
    yield from _live_doubts(case)
    yield from _steel_doubts(case)
    yield from _bar_doubts(case)
    vary = getattr(case.analysis, "vary", None)
    if case.load and isinstance(vary, str) and vary.rpartition(".")[2] == "thickness":
        message = "thickness is the depth out of plane, and point loads do not grow with it; a width is in 'block'"
        yield CaseProblem(("analysis", "vary"), message)


def _material_doubts(case: Case) -> Iterator[CaseProblem]:
    """Check densities; one heavy material among usual ones is taken for a load drawn as a block."""
    usual = any(USUAL["density"].doubt(material.density) is None for material in case.materials.values())
    for name, material in case.materials.items():
        text = USUAL["density"].doubt(material.density)
        if text and not (usual and material.density > USUAL["density"].high):
            yield CaseProblem(("materials", name, "density"), text)


def _joint_doubts(joint: CaseModel, path: KeyPath) -> Iterator[CaseProblem]:
    """Check friction coefficients and strengths of a joint; 0 means that there is none."""
    friction = getattr(joint, "friction", None)
    if friction is not None and STEEPEST < friction < LOCKED and friction not in NO_SLIP:
        angle = math.degrees(math.atan(friction))
        message = f"{show(friction)} is unusual for tan(phi), phi = {angle:.3g} deg; "
        yield CaseProblem((*path, "friction"), message + "an angle is given as friction_angle_deg")
    for key in type(joint).model_fields:
        value = getattr(joint, key)
        tangent = key == "friction_angle_deg" and value is not None and 0.05 <= value <= STEEPEST
        also = (f"friction = {show(value)}",) if tangent else ()
        if key in USUAL and value and (text := USUAL[key].doubt(value, *also)):
            yield CaseProblem((*path, key), text)


def _steel_doubts(case: Case) -> Iterator[CaseProblem]:
    """Check moduli, yield stresses and sections of ties and bars for wrong units."""
    tables: list[tuple[KeyPath, CaseModel]] = [(("tie", i), tie) for i, tie in enumerate(case.tie)]
    tables += [(("bars", name), bar) for name, bar in case.bars.items()]
    for path, table in tables:
        for key in ("young", "yield_stress", "area"):
            value = getattr(table, key, None)
            if value and (text := USUAL[key].doubt(value)):
                yield CaseProblem((*path, key), text)


def _bar_doubts(case: Case) -> Iterator[CaseProblem]:
    """Check for bar elements so long that bond acts too stiffly."""
    for i, table in enumerate(case.reinforcement):
        decay = case.bars[table.bar].decay
        if table.element is not None and decay * table.element > COARSE:
            message = (
                f"{show(table.element)} m is long beside 1/μ = √(EA/bond_stiffness) = {1.0 / decay:.3g} m: bond acts "
            )
            message += f"too stiffly (by 5 % at 0.4/μ, as its square); 0.2/μ = {0.2 / decay:.3g} m is the default"
            yield CaseProblem(("reinforcement", i, "element"), message)


def _live_doubts(case: Case) -> Iterator[CaseProblem]:
    """Check for live loads and directions that the analysis does not use or that act vertically only."""
    pattern = getattr(case.analysis, "pattern", None)
    live: list[KeyPath] = [("load", i) for i, load in enumerate(case.load) if load.kind == "live"]
    live += [("pressure", i) for i, pressure in enumerate(case.pressure) if pressure.kind == "live"]
    if live and pattern != "live":
        more = f" (and {len(live) - 1} more)" if len(live) > 1 else ""
        why = f"kind = {show(case.analysis.kind)} has no live load"
        if pattern is not None:
            why = f"the live load of pattern = {show(pattern)} is the weight of the blocks; "
            why += "point loads and pressures take part with pattern = 'live'"
        yield CaseProblem((*live[0], "kind"), f"not used{more}: {why}")
    if pattern == "live" and "direction" in case.analysis.model_fields_set:
        yield CaseProblem(("analysis", "direction"), "not used: pattern = 'live' has its own directions", at_key=True)
    elif pattern == "mass":
        *sideways, up = case.analysis.direction
        length = math.hypot(*sideways, up)
        if length > 0.0 and math.hypot(*sideways) <= VERTICAL * length:
            what = "heavier" if up < 0.0 else "lighter"
            message = f"along gravity: blocks become {what}, and nothing pushes them sideways"
            yield CaseProblem(("analysis", "direction"), message)


class BlockSizes(NamedTuple):
    """Sizes and thicknesses of the movable blocks in the order of the case file."""

    ids: Sequence[str]
    paths: Sequence[KeyPath]  # of the tables that they come from
    sizes: Sequence[float]  # root of the area, cube root of the volume [m]
    thickness: Sequence[float]  # depth out of plane [m]
    median: float  # of the sizes [m]
    extent: float  # of all of them together [m]
    dimension: int


def size_doubts(blocks: BlockSizes) -> Iterator[CaseProblem]:
    """Yield one warning each about blocks too large or too thick to be given in metres."""
    if not blocks.sizes:
        return
    several = len(blocks.sizes) >= MANY
    usual = USUAL["blocks" if several else "block"]
    usual = usual._replace(what=usual.what.format(root=ROOTS[blocks.dimension].format("their" if several else "its")))
    if text := usual.doubt(float(f"{blocks.median:.4g}")):
        first = next(i for i, size in enumerate(blocks.sizes) if size >= blocks.median)
        yield CaseProblem(blocks.paths[first], f"block '{blocks.ids[first]}': {text}")
    deepest = max(range(len(blocks.thickness)), key=lambda i: blocks.thickness[i])
    depth, usual = blocks.thickness[deepest], USUAL["thickness"]
    if depth > DEEP and depth > DEEPER_THAN_WIDE * blocks.extent:
        usual = usual._replace(high=0.0, what=f"a structure {blocks.extent:.3g} m in size")
    if text := usual.doubt(depth):
        yield CaseProblem((*blocks.paths[deepest], "thickness"), text)


DEEP, DEEPER_THAN_WIDE = 5.0, 10.0  # [m]; a depth above both is implausible for any structure
