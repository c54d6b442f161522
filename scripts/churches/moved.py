"""Displacement of the top of the left nave wall before failure, without slip (A3)."""

from __future__ import annotations

from typing import Any

from churches.cases import model
from churches.geometry import Slice
from churches.runs import solve
from dem_cli.bench.table import lines_of, percent

AT = {0.05: 0.0054, 0.056: 0.0083}  # load and displacement of the thesis [m]
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
    """Raised from gravity in steps of 0.002, for three readings of the stiffness."""
    found = {}
    for exponent in EXPONENTS:
        case = sprung(model("church_a_no_slip", step=0.002, max_steps=12_000_000), 6.0 * 10**exponent * TONNE)
        one = solve(f"church_a_no_slip, springs of 6e{exponent} t/m", case)
        kept = ("command", "status", "bracket", "curve", "steps", "seconds", "warnings")
        found[str(exponent)] = {key: one[key] for key in kept}
    return found


def page(found: dict[str, Any]) -> list[str]:
    """This part of church.md."""
    rows = []
    for exponent, one in found.items():
        cells = []
        for load, thesis in AT.items():
            at = moved(one["curve"], load)
            cells += ["does not stand", "–"] if at is None else [f"{1e3 * at:.1f}", percent(at / thesis - 1.0)]
        low, high = one["bracket"]
        rows.append((f"6 × 10^{exponent} t/m", *cells, f"{low:.4f} to {high:.4f}" if high else f"above {low:.4f}"))
    head = ("spring of a node", *(cell for load in AT for cell in (f"dem at {load:g}", "error")), "failure")
    thesis = ", ".join(f"{1e3 * moved:.1f} mm at {load:g}" for load, moved in AT.items())
    return [
        "## Displacement before failure, no slip (A3)", "",
        f"Top of the left nave wall [mm]; thesis {thesis}.",
        "The thesis has springs at the nodes, of 6 × 10^? t/m: the exponent is damaged in the text. With springs of",
        "that kind at both ends of every joint and moving geometry:", "",
        *lines_of(head, rows), "",
        "Its blocks are elastic besides (joints have less than a tenth of the vertical displacement, A3); ours are",
        "rigid. So this shows which exponent is likely, and that joints this stiff hardly lower the load; it is no",
        "prediction.", "",
    ]  # fmt: skip


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
