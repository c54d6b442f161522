"""Every joint law and feature of joints while the ground moves: it runs, and the books close."""

from __future__ import annotations

import engine
import pytest
from engine import block, rectangle, tables

JOINTS = {
    "coulomb": {"friction": 0.5},
    "softening": {"friction": 0.5, "softening": {"residual": 0.6, "slip_start": 1e-3, "slip_length": 1e-3}},
    "profile": {"friction": 0.5, "profile": {"sides": 3, "aperture": 1e-3}},
    "points": {"friction": 0.5, "points": 5},
    "mohr-coulomb": {"law": "mohr-coulomb", "friction": 0.5, "cohesion": 3e4, "tension": 1e4},
    "barton": {"law": "barton", "jrc": 8.0, "jcs": 5e7, "residual_angle_deg": 26.0},
    "rate-dependent": {"law": "rate-dependent", "friction": 0.5, "friction_dynamic": 0.3, "velocity": 0.05},
    "crushing": {"law": "crushing", "friction": 0.5, "compression": 1e6},
    "fracture": {
        "law": "fracture", "friction": 0.5, "cohesion": 3e4, "tension": 1e4,
        "fracture_energy_tension": 10.0, "fracture_energy_shear": 30.0,
    },
    "elastic": {"law": "elastic"},
}  # fmt: skip


def shaken(joint: dict, **more) -> tuple[dict, engine.Records]:
    """A column that slides and rocks for a second, at a step that shows errors of the books."""
    blocks = [block("base", rectangle(-2, -0.5, 2, 0), fixed=True)]
    blocks += [block(f"b{i}", rectangle(-0.3, 0.4 * i, 0.3, 0.4 * i + 0.4)) for i in range(3)]
    case = {
        "joints": {"j": {"kn": 1e9, **joint}},
        "motion": {"kind": "harmonic", "amplitude": 6.0, "frequency": 3.0, "duration": 1.0},
        "analysis": {"kind": "time-history", "margin": 0.15},
        "monitor": [{"block": "b2", "component": "x"}],
    }
    return engine.solve(tables(*blocks, **case | more))


@pytest.mark.parametrize("name", JOINTS)
def test_every_law_closes_its_books(name):
    summary, records = shaken(JOINTS[name])
    assert summary["status"] == "ok"
    assert abs(summary["energy_closure"]) < 1e-3
    assert records.history.monitors.std() > 1e-6


def test_friction_that_falls_with_speed_lets_blocks_slide_farther():
    """The law knows the time step: with a speed that no joint reaches its friction is the static one."""
    farther, static = (
        shaken(JOINTS["rate-dependent"] | {"velocity": speed})[1].rows[-1].energy.friction for speed in (0.01, 1e6)
    )
    coulomb = shaken(JOINTS["coulomb"])[1].rows[-1].energy.friction
    assert static == pytest.approx(coulomb, rel=1e-3)
    assert farther != pytest.approx(coulomb, rel=0.05)


def test_laws_of_one_scene_differ():
    """A bonded joint on a dry one, blocks of two parts, and a second structure beside."""
    blocks = [
        block("base", rectangle(-2, -0.5, 4, 0), fixed=True, material="stone"),
        block("low", rectangle(-0.3, 0.0, 0.3, 0.5), material="stone"),
        {"id": "l", "parts": [rectangle(-0.3, 0.5, 0.0, 1.1), rectangle(0.0, 0.5, 0.3, 0.8)], "material": "tuff"},
        block("beside", rectangle(2.0, 0.0, 2.4, 1.2), material="tuff"),
    ]
    case = tables(*blocks)
    case["materials"] = {"stone": {"density": 2400.0}, "tuff": {"density": 1600.0}}
    case["joints"] = {"dry": {"friction": 0.5, "kn": 1e9}, "mortar": {"kn": 1e9, **JOINTS["mohr-coulomb"]}}
    case["interface"] = [{"between": ["stone", "tuff"], "joint": "mortar"}]
    case["motion"] = {"kind": "pulse", "amplitude": 7.0, "frequency": 2.0}
    case["analysis"] = {"kind": "time-history", "duration": 1.5, "margin": 0.15}
    summary, _ = engine.solve(case)
    assert summary["status"] == "ok"
    assert abs(summary["energy_closure"]) < 1e-3
