"""Virtual work of the seven-body mechanism (A4): four walls and three roofs, joined by hinges; no line of dem in it."""

from __future__ import annotations

from typing import Any

import numpy as np

from churches.geometry import Slice, tables

BODIES = ("a", "roof-a", "b", "roof-n", "c", "roof-d", "d")


def hinges(bay: Slice) -> list[tuple[str, str | None, tuple[float, float]]]:
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
    """Load multiplier of the mechanism, of one degree of freedom: −(work of gravity)/(work of the lateral load)."""
    rows = []
    for first, second, (x, z) in hinges(bay):
        for axis in (0, 1):
            row = np.zeros(3 * len(BODIES))
            for body, sign in ((first, 1.0), (second, -1.0)):
                if body is not None:
                    at = 3 * BODIES.index(body)
                    row[at + axis] = sign
                    row[at + 2] = sign * (-z if axis == 0 else x)  # velocity of a point: (u − ω z, w + ω x)
            rows.append(row)
    _, sizes, vectors = np.linalg.svd(np.array(rows))
    (motion,) = vectors[len(sizes[sizes > 1e-9 * sizes[0]]) :]
    case = tables(bay, "")
    falls = pushed = 0.0
    for block in case["block"]:
        body = body_of(block["id"])
        if body is None:
            continue
        mass, (x, z) = mass_and_centroid(block, case["materials"][block["material"]]["density"])
        u, w, turn = motion[3 * BODIES.index(body) :][:3]
        pushed += mass * -(u - turn * z)
        falls += mass * -(w + turn * x)
    return float(-falls / pushed)


def mass_and_centroid(block: dict[str, Any], density: float) -> tuple[float, np.ndarray]:
    """[kg], [m]."""
    total, moment = 0.0, np.zeros(2)
    for part in block.get("parts") or [block["vertices"]]:
        p = np.array(part)
        q = np.roll(p, -1, axis=0)
        cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
        total += 0.5 * cross.sum()
        moment += ((p + q) * cross[:, None]).sum(axis=0) / 6.0
    return abs(total) * density * block["thickness"], moment / total
