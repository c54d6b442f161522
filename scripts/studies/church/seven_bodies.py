"""The mechanism of seven bodies (A4): four walls and three roofs, joined by hinges; its load by virtual work."""

from __future__ import annotations

from typing import Any

import numpy as np
from oracle.hinged_bodies import Hinge, area_and_centroid, multiplier

from studies.church.geometry import Slice, tables

BODIES = ("a", "roof-a", "b", "roof-n", "c", "roof-d", "d")


def hinges(bay: Slice) -> list[Hinge]:
    """Body, body (None: ground) and place of the ten hinges when everything turns to the left."""
    b, c = bay.axes
    half = bay.thick / 2
    far = bay.right_face + bay.right_wall
    return [
        ("a", None, (0.0, 0.0)),
        ("b", None, (b - bay.left_column / 2, bay.foot)),
        ("c", None, (c - bay.right_column / 2, bay.foot)),
        ("d", None, (bay.right_face, 0.0)),
        ("a", "roof-a", (bay.left_wall - bay.lean, bay.side)),
        ("roof-a", "b", (b - half, bay.seat)),
        ("b", "roof-n", (b + half, bay.top)),
        ("roof-n", "c", (c + half, bay.top)),
        ("c", "roof-d", (c + half + bay.bracket, bay.seat)),
        ("roof-d", "d", (far, bay.side)),
    ]


def body_of(block: str) -> str | None:
    """Which of the seven a block belongs to; None: it stays."""
    if block in ("ground", "b-drum-1", "c-drum-1"):
        return None
    if block.startswith("roof") or block == "tie":
        return "roof-n" if block == "tie" else block
    return block.split("-")[0]


def seven_bodies(bay: Slice) -> float:
    """Load multiplier of the mechanism."""
    case = tables(bay, "")
    weights = []
    for block in case["block"]:
        if (body := body_of(block["id"])) is not None:
            weights.append((body, *mass_and_centroid(block, case["materials"][block["material"]]["density"])))
    return multiplier(BODIES, hinges(bay), weights)


def mass_and_centroid(block: dict[str, Any], density: float) -> tuple[float, np.ndarray]:
    """[kg], [m]."""
    area, centroid = area_and_centroid(block.get("parts") or [block["vertices"]])
    return area * density * block["thickness"], centroid
