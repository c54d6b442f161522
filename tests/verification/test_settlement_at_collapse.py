"""How far a support may settle before the structure falls, against statics of rigid blocks with finite rotations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from casefiles import CASES
from oracle.limit_lp import area_and_centroid
from scipy.optimize import brentq

import dem_cli

LEFT = np.array([[-1.4, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, 1.4]])  # of the case
FOOT, CROWN = np.array([-1.0, 0.0]), np.array([0.0, 1.4])
FRICTION, MOVED = 0.4, 0.6  # tan φ; the whole way of the support [m]


def thrust(spread: float) -> float:
    """Thrust over weight of each half with the feet so much further apart [m]: moments about the foot, H h = W a."""
    half, length = -FOOT[0] + 0.5 * spread, float(np.linalg.norm(CROWN - FOOT))
    height = math.sqrt(length**2 - half**2)
    turned = math.atan2(height, half) - math.atan2(CROWN[1], -FOOT[0])
    x, y = np.asarray(area_and_centroid(LEFT)[1]) - FOOT
    return float((math.cos(turned) * x - math.sin(turned) * y) / height)


def test_two_blocks_slide_apart():
    """They stand as long as the thrust at the feet is below friction: 0.4283 m; the bracket is 1/200 of the way."""
    exact = brentq(lambda spread: thrust(spread) - FRICTION, 0.1, 1.0)
    changes = {
        "joints.dry.friction": FRICTION, "joints.dry.kn": "auto", "settlement.0.displacement": [MOVED, 0.0],
        "output.frames": 0, "reference": [],
    }  # fmt: skip
    with dem_cli.run(CASES / "verification" / "settlement_two_blocks.toml", changes) as result:
        summary = result.summary
    assert summary["status"] == "collapsed under the settlement"
    found = summary["settlement_at_collapse"]
    low, high = found["bracket"]
    assert low < exact / MOVED < high
    assert high - low == pytest.approx(1 / 200)
    assert found["supports"] == {"foot-right": {"displacement": [low * MOVED, 0.0], "rotation": 0.0}}
    assert summary["mechanism"]["moving_blocks"]["first"] == ["left", "right"]


def test_what_stands_has_no_settlement_at_collapse():
    with dem_cli.run(CASES / "verification" / "settlement_two_blocks.toml", {"output.frames": 0}) as result:
        assert result.status == "ok"
        assert "settlement_at_collapse" not in result.summary
        cracks = result.summary["joint_state"]["crack_width"]
    turn = 0.0361899  # of each block, as the case has it in closed form: feet open at their outer ends, 0.4 m away
    crown = 0.4 * math.sin(2 * turn)  # both turn away from each other about its upper end
    assert cracks["value"] == pytest.approx(crown, rel=0.005)
    assert cracks["between"] == ["left", "right"]
