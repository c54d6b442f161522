"""A column that is bent: blocks of every kind beside Timoshenko's beam on elastic joints, a closed form."""

from __future__ import annotations

from typing import Any

from bench.table import percent

from studies.deformable.elastic_wall import compliance
from studies.deformable.lumped import RATIOS, WAYS
from studies.solution import from_tables
from studies.template import table

BLOCKS, HEIGHT, WIDTH, THICKNESS = 8, 0.3, 0.4, 0.5  # [m]
YOUNG, POISSON, SHEAR = 5e9, 0.2, 0.4  # [Pa], [-], ks/kn


def measure() -> dict[str, Any]:
    """How far a force at the top moves along itself [m/N]."""
    rows = [
        {"ratio": ratio, "exact": _rounded(by_hand(ratio))} | {way: _rounded(displacement(ratio, way)) for way in WAYS}
        for ratio in RATIOS
    ]
    return {"rows": rows}


def by_hand(ratio: float) -> float:
    """Bending and shear of the beam, and of the joints at its foot and between its blocks [m/N]; ratio: kn h/E."""
    kn, modulus = ratio * YOUNG / HEIGHT, YOUNG / (2.0 * (1.0 + POISSON))
    area, inertia, length = WIDTH * THICKNESS, THICKNESS * WIDTH**3 / 12.0, BLOCKS * HEIGHT
    found = length**3 / (3.0 * YOUNG * inertia) + length / (5.0 / 6.0 * modulus * area)
    arms = (length - k * HEIGHT for k in range(BLOCKS))
    return found + sum(arm**2 / (kn * inertia) + 1.0 / (SHEAR * kn * area) for arm in arms)


def displacement(ratio: float, way: str) -> float:
    """The same of blocks and joints [m/N]; way: how blocks deform."""
    kn, half = ratio * YOUNG / HEIGHT, WIDTH / 2.0
    blocks = [{"id": "foot", "fixed": True, **_block(-half, -HEIGHT)}]
    blocks += [{"id": f"block-{k + 1}", **_block(-half, k * HEIGHT)} for k in range(BLOCKS)]
    return compliance(from_tables({
        "title": "A column that is bent",
        "materials": {"stone": {"density": 2400.0, "young": YOUNG, "poisson": POISSON, "deformation": way}},
        "joints": {"elastic": {"law": "elastic", "kn": kn, "ks": SHEAR * kn, "points": 5}},
        "block": blocks,
        "load": [{"block": blocks[-1]["id"], "force": [1.0, 0.0], "at": [0.0, BLOCKS * HEIGHT], "kind": "live"}],
        "analysis": {"kind": "pushover", "pattern": "live"},
    }))  # fmt: skip


def _block(left: float, low: float) -> dict[str, Any]:
    corners = [[left, low], [left + WIDTH, low], [left + WIDTH, low + HEIGHT], [left, low + HEIGHT]]
    return {"vertices": corners, "thickness": THICKNESS}


def _rounded(value: float) -> float:
    return float(f"{value:.6g}")


def values(found: dict[str, Any]) -> dict[str, str]:
    """The table of the page."""
    rows = [
        (f"{one['ratio']:g}", f"{1e9 * one['exact']:.0f}", *(percent(one[way] / one["exact"] - 1.0) for way in WAYS))
        for one in found["rows"]
    ]
    return {"rows": table(("kn h/E", "by hand [nm/N]", *WAYS.values()), rows)}


PICTURES: dict[str, Any] = {}
