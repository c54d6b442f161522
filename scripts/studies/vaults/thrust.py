"""Thrust of groin and cloister vaults under their own weight, between the least and the largest in equilibrium."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from oracle.thrust import thrust_range

from studies.template import table
from studies.vaults.runs import GRAVITY, last_contacts, on_supports, solved

VAULT = {"kind": "vault", "shape": "groin", "span": 4.0, "voussoirs": 11, "rows": 4, "included_angle_deg": 140.0}
THICKNESSES, FRICTION = (0.2, 0.3, 0.4), 0.7


def measure(thicknesses: Sequence[float] = THICKNESSES, **joint: Any) -> dict[str, Any]:
    """Supports one by one, and the range, of a groin vault and of a cloister vault; joint: more keys of its joints."""
    return {"rows": measured("groin", thicknesses, **joint), "cloister": measured("cloister", thicknesses, **joint)}


def measured(shape: str, thicknesses: Sequence[float], **joint: Any) -> list[dict[str, Any]]:
    """Of each thickness the forces on supports over the weight, and the range of the thrust per support."""
    rows, rough = [], {"friction": FRICTION, **joint}
    for thickness in thicknesses:
        done = solved(VAULT | {"shape": shape, "thickness": thickness}, rough, {"kind": "gravity"})
        supports = on_supports(done.model, last_contacts(done))
        contacts, model = last_contacts(done), done.model
        low, high = thrust_range(contacts, model.centroids, model.masses * GRAVITY, model.fixed, FRICTION)
        rows.append(
            {
                "thickness": thickness,
                "status": done.summary["status"],
                "supports": supports,
                "range": [round(low, 5), round(high, 5)],
            }
        )
    return rows


def values(found: dict[str, Any]) -> dict[str, str]:
    """Tables of the page."""
    return {"thrust": _groin(found["rows"]), "cloister": _cloister(found["cloister"])}


def _cloister(found: Sequence[dict[str, Any]]) -> str:
    """Each support is a wall: it is pushed square to itself, and two of four of them along x."""
    rows = []
    for row in found:
        forces = list(row["supports"].values())
        pushes = sorted(max(abs(force[0]), abs(force[1])) for force in forces)
        aside = max(min(abs(force[0]), abs(force[1])) for force in forces)
        downs = sorted(-force[2] for force in forces)
        rows.append(
            [
                f"{row['thickness']:g}",
                f"{downs[0]:.4f} to {downs[-1]:.4f}",
                f"{pushes[0]:.4f} to {pushes[-1]:.4f}",
                f"{aside:.4f}",
                f"{2.0 * row['range'][0]:.4f} to {2.0 * row['range'][1]:.4f}",
            ]
        )
    head = [
        "thickness [m]",
        "vertical, each wall",
        "thrust, each wall",
        "along the wall, at most",
        "forces in equilibrium",
    ]
    return table(head, rows)


def _groin(found: Sequence[dict[str, Any]]) -> str:
    rows = []
    for row in found:
        forces = list(row["supports"].values())
        pushes = sorted(abs(force[k]) for force in forces for k in (0, 1))
        downs = sorted(-force[2] for force in forces)
        rows.append(
            [
                f"{row['thickness']:g}",
                f"{downs[0]:.4f} to {downs[-1]:.4f}",
                f"{pushes[0]:.4f} to {pushes[-1]:.4f}",
                f"{row['range'][0]:.4f} to {row['range'][1]:.4f}",
            ]
        )
    head = ["thickness [m]", "vertical, each corner", "thrust along x and y, each corner", "forces in equilibrium"]
    return table(head, rows)


PICTURES: dict[str, Any] = {}
