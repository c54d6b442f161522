"""Plausibility of a case: what is allowed, but looks like a slip, most often a wrong unit."""

from __future__ import annotations

from collections.abc import Iterator

from dem_cli.case.schema import Case
from dem_cli.case.wording import show
from dem_cli.errors import CaseProblem

LIGHTEST, HEAVIEST = 100.0, 25000.0  # kg/m3: cork and osmium, about
STEEPEST = 5.0  # tan(79°)
SHAKES = ("time-history", "fragility")  # kinds of analysis that take place in time


def doubts(case: Case) -> Iterator[CaseProblem]:
    """Warnings about a valid case."""
    for name, material in case.materials.items():
        if not LIGHTEST <= material.density <= HEAVIEST:
            message = f"{show(material.density)} kg/m3 is unusual for a building material"
            if LIGHTEST <= material.density * 1000.0 <= HEAVIEST:  # given in g/cm3
                message += f", did you mean {show(material.density * 1000.0)}?"
            yield CaseProblem(("materials", name, "density"), message)
    for name, joint in case.joints.items():
        friction = getattr(joint, "friction", None)
        if friction is not None and friction > STEEPEST:
            message = f"{show(friction)} is unusual for tan(phi); an angle is given as friction_angle_deg"
            yield CaseProblem(("joints", name, "friction"), message)
    if case.gravity == 0.0:
        yield CaseProblem(("gravity",), "0 leaves the blocks without weight")
    elif not 0.5 <= case.gravity <= 30.0:
        yield CaseProblem(("gravity",), f"{show(case.gravity)} m/s2 is unusual; on Earth it is 9.81")
    for table in () if case.analysis.kind in SHAKES else ("motion", "damping", "initial"):
        if getattr(case, table):
            yield CaseProblem((table,), f"not used: kind = {show(case.analysis.kind)} has no time", at_key=True)
