"""A column that is bent or pressed: blocks of every kind beside a beam on elastic joints, closed forms; 2D and 3D."""

from __future__ import annotations

from typing import Any

from bench.table import percent

from studies.deformable.elastic_wall import compliance
from studies.deformable.lumped import WAYS
from studies.solution import from_tables
from studies.template import table

BLOCKS, HEIGHT, WIDTH, THICKNESS = 8, 0.3, 0.4, 0.5  # [m]
YOUNG, POISSON, SHEAR = 5e9, 0.2, 0.4  # [Pa], [-], ks/kn


RATIOS = (0.05, 0.1, 0.44, 1.0, 3.0, 10.0)  # kn h/E
IN_SPACE = {key: word for key, word in WAYS.items() if key != "quadratic"}  # not known there


def measure() -> dict[str, Any]:
    """How far a force at the top moves along itself [m/N], across the column and along it."""
    return {
        f"{load}-{dimension}": [
            {"ratio": ratio, "exact": _rounded(exact(ratio))}
            | {way: _rounded(displacement(ratio, way, dimension, load)) for way in ways}
            for ratio in RATIOS
        ]
        for load, exact in (("bent", by_hand), ("pressed", pressed_by_hand))
        for dimension, ways in ((2, WAYS), (3, IN_SPACE))
    }


def by_hand(ratio: float) -> float:
    """Bending and shear of the beam, and of the joints at its foot and between its blocks [m/N]; ratio: kn h/E."""
    kn, modulus = ratio * YOUNG / HEIGHT, YOUNG / (2.0 * (1.0 + POISSON))
    area, inertia, length = WIDTH * THICKNESS, THICKNESS * WIDTH**3 / 12.0, BLOCKS * HEIGHT
    found = length**3 / (3.0 * YOUNG * inertia) + length / (5.0 / 6.0 * modulus * area)
    arms = (length - k * HEIGHT for k in range(BLOCKS))
    return found + sum(arm**2 / (kn * inertia) + 1.0 / (SHEAR * kn * area) for arm in arms)


def pressed_by_hand(ratio: float) -> float:
    """Shortening of the blocks, free to swell, and of their joints [m/N]; ratio: kn h/E."""
    return BLOCKS * (HEIGHT / YOUNG + HEIGHT / (ratio * YOUNG)) / (WIDTH * THICKNESS)


def displacement(ratio: float, way: str, dimension: int = 2, load: str = "bent") -> float:
    """Compute how far the top of the column of blocks moves along a force there [m/N].

    way: how blocks deform; load: "bent" or "pressed".
    """
    kn, half = ratio * YOUNG / HEIGHT, WIDTH / 2.0
    blocks = [{"id": "foot", "fixed": True, **_block(-half, -HEIGHT, dimension)}]
    blocks += [{"id": f"block-{k + 1}", **_block(-half, k * HEIGHT, dimension)} for k in range(BLOCKS)]
    force, at = ([1.0, 0.0] if load == "bent" else [0.0, -1.0]), [0.0, BLOCKS * HEIGHT]
    if dimension == 3:
        force, at = [force[0], 0.0, force[1]], [at[0], THICKNESS / 2.0, at[1]]
    return compliance(from_tables({
        "title": f"A column that is {load}",
        "dimension": dimension,
        "materials": {"stone": {"density": 2400.0, "young": YOUNG, "poisson": POISSON, "deformation": way}},
        "joints": {"elastic": {"law": "elastic", "kn": kn, "ks": SHEAR * kn, "points": 5}},
        "block": blocks,
        "load": [{"block": blocks[-1]["id"], "force": force, "at": at, "kind": "live"}],
        "analysis": {"kind": "pushover", "pattern": "live"},
    }))  # fmt: skip


def _block(left: float, low: float, dimension: int) -> dict[str, Any]:
    corners = [[left, low], [left + WIDTH, low], [left + WIDTH, low + HEIGHT], [left, low + HEIGHT]]
    if dimension == 3:
        return {"vertices": [[x, y, z] for x, z in corners for y in (0.0, THICKNESS)]}
    return {"vertices": corners, "thickness": THICKNESS}


def _rounded(value: float) -> float:
    return float(f"{value:.6g}")


def values(found: dict[str, Any]) -> dict[str, str]:
    """The tables of the page."""
    return {
        f"{load}_{dimension}": _table(found[f"{load}-{dimension}"], ways)
        for load in ("bent", "pressed")
        for dimension, ways in ((2, WAYS), (3, IN_SPACE))
    }


def _table(found: list[dict[str, Any]], ways: dict[str, str]) -> str:
    """Errors of every kind of block against the closed form, by stiffness of the joints."""
    rows = [
        (f"{one['ratio']:g}", f"{1e9 * one['exact']:.4g}", *(percent(one[way] / one["exact"] - 1.0) for way in ways))
        for one in found
    ]
    return table(("kn h/E", "by hand [nm/N]", *ways.values()), rows)


PICTURES: dict[str, Any] = {}
