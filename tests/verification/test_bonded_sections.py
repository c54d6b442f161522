"""Squat piers on bonded joints, pushed until the toe is crushed or the bed has cracked, against a fibre section."""

from __future__ import annotations

import pytest
from engine import block, rectangle, solve, tables
from oracle.fibre_section import Bond, bent
from oracle.fibre_section import rectangle as fibres

WIDE, DEEP, TALL = 0.4, 0.3, 0.5  # m
FT, FC, ENERGY, KN = 3e5, 4e6, 30.0, 2e10
JOINT = {"friction": 0.7, "tension": FT, "cohesion": 6e6, "compression": FC, "kn": KN, "ks": 0.4 * KN}
LAWS = {
    "mohr-coulomb": {},
    "fracture": {"fracture_energy_tension": ENERGY, "fracture_energy_shear": 3e4},
}


def pier(law: str, share: float, halves: bool = False, **joint) -> float:
    """The largest horizontal force at the top [N] under N = share fc A; halves: on two blocks side by side."""
    parts = [(-1.0, 0.5 * WIDE), (0.5 * WIDE, 1.4)] if halves else [(-1.0, 1.4)]
    base = [block(f"base{i}", rectangle(a, -0.3, b, 0.0), fixed=True, thickness=DEEP) for i, (a, b) in enumerate(parts)]
    at = [WIDE / 2, TALL]
    case = tables(
        *base, block("pier", rectangle(0.0, 0.0, WIDE, TALL), thickness=DEEP),
        materials={"stone": {"density": 1.0}},
        joints={"bed": {"law": law, **JOINT, **LAWS[law], **joint}},
        load=[
            {"block": "pier", "force": [0.0, -share * FC * WIDE * DEEP], "at": at},
            {"block": "pier", "force": [1000.0, 0.0], "at": at, "kind": "live"},
        ],
        analysis={"kind": "pushover", "pattern": "live", "kinematics": "fixed", "resolution": 0.002},
    )  # fmt: skip
    summary, _ = solve(case)
    assert summary["status"] == "ok"
    return 1000.0 * summary["failure_load"]


def exact(law: str, share: float) -> float:
    bond = Bond(FT, KN, FC, ENERGY if law == "fracture" else 0.0)
    return bent(fibres(WIDE, DEEP, 400), bond, share * FC * WIDE * DEEP, 40).strength / TALL


@pytest.mark.parametrize("share", [0.02, 0.1, 0.8])
def test_a_pier_whose_bed_cracks_and_whose_toe_is_crushed(share):
    assert pier("fracture", share) == pytest.approx(exact("fracture", share), rel=0.01)


def test_five_points_carry_more():
    assert pier("fracture", 0.02, points=5) > 1.05 * exact("fracture", 0.02)


def test_two_joints_side_by_side_are_as_strong_as_one():
    assert pier("fracture", 0.1, halves=True) == pytest.approx(pier("fracture", 0.1), rel=0.01)


@pytest.mark.parametrize("share", [0.1, 0.5])
def test_a_brittle_pier(share):
    assert pier("mohr-coulomb", share) == pytest.approx(exact("mohr-coulomb", share), rel=0.01)


@pytest.mark.parametrize("across", [False, True])
def test_a_pier_in_space(across):
    """Pressed by 20 kN about either side, without a cap; nine points carried 18 % more."""
    prism = {"id": "pier", "polygon": [[0.0, 0.0], [WIDE, 0.0], [WIDE, TALL], [0.0, TALL]], "y": [0.0, DEEP]}
    base = {
        "id": "base",
        "fixed": True,
        "polygon": [[-1.0, -0.3], [1.4, -0.3], [1.4, 0.0], [-1.0, 0.0]],
        "y": [-1, 1.3],
    }
    at, way = [WIDE / 2, DEEP / 2, TALL], [0.0, 1000.0, 0.0] if across else [1000.0, 0.0, 0.0]
    joint = {key: value for key, value in JOINT.items() if key != "compression"}
    summary, _ = solve({
        "title": "pier", "dimension": 3, "materials": {"stone": {"density": 1.0}}, "block": [base, prism],
        "joints": {"bed": {"law": "fracture", **joint, **LAWS["fracture"]}},
        "load": [
            {"block": "pier", "force": [0.0, 0.0, -20000.0], "at": at},
            {"block": "pier", "force": way, "at": at, "kind": "live"},
        ],
        "analysis": {"kind": "pushover", "pattern": "live", "kinematics": "fixed", "resolution": 0.002},
    })  # fmt: skip
    wide, deep = (DEEP, WIDE) if across else (WIDE, DEEP)
    whole = bent(fibres(wide, deep, 400), Bond(FT, KN, energy=ENERGY), 20000.0, 40).strength / TALL
    assert 1000.0 * summary["failure_load"] == pytest.approx(whole, rel=0.01)
