"""Structures in space whose load no formula gives: walls that meet, tapered drums, an arch pushed askew."""

from __future__ import annotations

import math

import numpy as np

from studies.space.structures import box, corner_wall, frustum, regular, solid, tables, tee_wall, towards, u_wall

WINDOW = (2, 3)  # courses of an opening


def tapered_drums(azimuth: float = 20.0) -> dict:
    """Three drums with six sides that taper, pushed askew."""
    ground = box("ground", (-1.0, -1.0, -0.3), (1.0, 1.0, 0.0), fixed=True)
    apothems = (0.40, 0.36, 0.32, 0.28)
    drums = [
        frustum(f"drum-{k}", regular(6, low), regular(6, high), 0.5 * k, 0.5 * (k + 1))
        for k, (low, high) in enumerate(zip(apothems, apothems[1:]))
    ]
    return tables(ground, *drums, friction=0.7, direction=towards(azimuth))


def barrel_arch(
    azimuth: float, voussoirs: int = 15, radius: float = 1.0, ring: float = 0.18, depth: float = 0.5
) -> dict:
    """A semicircular arch along x on two fixed springings, pushed at an azimuth."""
    angles = np.linspace(0.0, math.pi, voussoirs + 1)

    def wedge(name: str, low: float, high: float, **more) -> dict:
        corners = [
            (r * math.cos(a), y, r * math.sin(a))
            for a in (low, high)
            for r in (radius - ring / 2, radius + ring / 2)
            for y in (0.0, depth)
        ]
        return solid(name, corners, **more)

    stones = [wedge(f"v{k}", low, high) for k, (low, high) in enumerate(zip(angles, angles[1:]))]
    feet = [
        box(f"foot-{side}", (side * radius - ring, -0.2, -0.3), (side * radius + ring, depth + 0.2, 0.0), fixed=True)
        for side in (-1, 1)
    ]
    return tables(*feet, *stones, friction=0.6, direction=towards(azimuth))


WALLS: dict[str, dict] = {
    "L, along x": tables(*corner_wall()),
    "L, away from the leg": tables(*corner_wall(), direction=towards(270.0)),
    "L, towards the leg": tables(*corner_wall(), direction=towards(90.0)),
    "U, away from the legs": tables(*u_wall(), direction=towards(270.0)),
    "U, towards the legs": tables(*u_wall(), direction=towards(90.0)),
    "U with a window, away from the legs": tables(*u_wall(window=WINDOW), direction=towards(270.0)),
    "T, away from the leg": tables(*tee_wall(), direction=towards(270.0)),
    "T, towards the leg": tables(*tee_wall(), direction=towards(90.0)),
    "T, askew": tables(*tee_wall(), direction=towards(60.0)),
    "tapered drums, askew": tapered_drums(),
    "barrel arch, along": barrel_arch(0.0),
    "barrel arch, 37° askew": barrel_arch(37.0),
}
