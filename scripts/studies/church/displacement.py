"""Displacement of the top of the left nave wall before failure, without slip (A3)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from bench.table import percent

from studies.church.cases import model
from studies.church.geometry import FITTED_SIDE, Slice
from studies.church.mechanism import solved
from studies.template import bracket, table

AT = {0.05: 0.0054, 0.056: 0.0083}  # load and displacement of the thesis [m]
CURVE_KEPT = ("command", "status", "bracket", "curve", "steps", "seconds", "warnings")
TONNE = 9806.65  # N
EXPONENTS = (5, 6, 7)  # of 6 × 10^? t/m, the damaged stiffness of a node


def sprung(case: dict[str, Any], spring: float) -> dict[str, Any]:
    """The case with a spring [N/m], normal and tangential, at both ends of every joint: kn = 2 K over its area."""
    bay = Slice()
    areas = {
        "masonry": bay.thick * bay.bay, "wood-masonry": bay.bracket * bay.bay, "wood": bay.nave * 0.3,
        "peperino": bay.left_column**2, "travertine": bay.right_column**2,
    }  # fmt: skip
    joints = {}
    for name, area in areas.items():
        kn = 2.0 * spring / area
        joints[name] = {**case["joints"].get(name, case["joints"]["masonry"]), "kn": kn, "ks": kn}
    pairs = [{"between": [stone, other], "joint": stone}
             for stone in ("peperino", "travertine") for other in (stone, "tuff")]  # fmt: skip
    return case | {"joints": joints, "interface": [*case["interface"], *pairs]}


def measure() -> dict[str, Any]:
    """Raised from gravity in steps of 0.002, for three readings of the stiffness, on fitted side walls."""
    found = {}
    for exponent in EXPONENTS:
        case = sprung(
            model("church_a_no_slip", replace(Slice(), side=FITTED_SIDE), step=0.002, max_steps=12_000_000),
            6.0 * 10**exponent * TONNE,
        )
        found[str(exponent)] = solved(f"church_a_no_slip, springs of 6e{exponent} t/m", case, CURVE_KEPT)
    return found


def values(found: dict[str, Any]) -> dict[str, str]:
    """What displacement.md.j2 shows."""
    rows = []
    for exponent, one in found.items():
        cells = []
        for load, thesis in AT.items():
            at = moved(one["curve"], load)
            cells += ["does not stand", "–"] if at is None else [f"{1e3 * at:.1f}", percent(at / thesis - 1.0)]
        rows.append((f"6 × 10^{exponent} t/m", *cells, bracket(one["bracket"])))
    head = ("spring of a node", *(cell for load in AT for cell in (f"dem at {load:g}", "error")), "failure")
    said = ", ".join(f"{1e3 * far:.1f} mm at {load:g}" for load, far in AT.items())
    return {"thesis": said, "springs": table(head, rows)}


def moved(curve: list[list[float]], load: float) -> float | None:
    """Displacement to the left under a load since gravity [m]; None above the last equilibrium."""
    curve = sorted(curve)
    if load > curve[-1][0]:
        return None
    for (low, start), (high, end) in zip(curve, curve[1:], strict=False):
        if low <= load <= high:
            share = (load - low) / (high - low) if high > low else 0.0
            return -(start + share * (end - start) - curve[0][1])
    return None


PICTURES: dict[str, Any] = {}
