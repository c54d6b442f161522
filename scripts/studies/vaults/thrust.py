"""Thrust of a groin vault under its own weight, between the least and the largest of forces in equilibrium."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from oracle.thrust import thrust_range

from studies.template import table
from studies.vaults.runs import GRAVITY, last_contacts, on_supports, solved

VAULT = {"kind": "vault", "shape": "groin", "span": 4.0, "voussoirs": 11, "rows": 4, "included_angle_deg": 140.0}
THICKNESSES, FRICTION = (0.2, 0.3, 0.4), 0.7


def measure(thicknesses: Sequence[float] = THICKNESSES) -> dict[str, Any]:
    """Supports one by one, and the range."""
    rows = []
    for thickness in thicknesses:
        done = solved(VAULT | {"thickness": thickness}, {"friction": FRICTION}, {"kind": "gravity"})
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
    return {"rows": rows}


def values(found: dict[str, Any]) -> dict[str, str]:
    """Table of the page."""
    rows = []
    for row in found["rows"]:
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
    return {"thrust": table(head, rows)}


PICTURES: dict[str, Any] = {}
