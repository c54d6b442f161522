"""Loads that follow their blocks, load.follows: a rocking block against closed forms; what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, scene, solve, tables

from dem_cli.errors import CaseError

WIDE, HIGH = 0.4, 1.2
WEIGHT = 2000.0 * 9.81 * WIDE * HIGH
PRESS = 0.3 * WEIGHT  # dead, on the middle of the top
GO = 0.1  # of the middle of the top [m]


def pushed(follows: str | None, dimension: int = 2, pressed: str | None = "point") -> dict:
    """A block pushed and pressed at the middle of its top until that has gone sideways by GO."""
    across = [0.0] * (dimension - 2)

    def box(name: str, left: float, low: float, right: float, high: float, **more) -> dict:
        if dimension == 2:
            return block(name, rectangle(left, low, right, high), **more)
        corners = [[x, y, z] for x in (left, right) for y in (-0.5, 0.5) for z in (low, high)]
        return {"id": name, "vertices": corners, **more}

    top, turn = [0.0, *across, HIGH], {} if dimension == 2 else {"component": "y"}
    live = {"block": "block", "force": [WEIGHT, *across, 0.0], "at": top, "kind": "live"}
    dead = {"block": "block", "force": [0.0, *across, -PRESS], "at": top}
    analysis = {"kind": "cycle", "pattern": "live", "control": "displacement", "path": [GO], "step": 0.05, "of": "top"}
    return tables(
        box("ground", -1.0, -0.2, 3.0, 0.0, fixed=True), box("block", -WIDE / 2, 0.0, WIDE / 2, HIGH),
        friction=0.9, dimension=dimension, analysis=analysis,
        load=[live | ({"follows": follows} if follows else {}), dead | ({"follows": pressed} if pressed else {})],
        monitor=[{"name": "top", "point": top, "component": "x"},
                 {"name": "turn", "block": "block", "quantity": "rotation", **turn}],
    )  # fmt: skip


def closed_form(follows: str | None, pressed: str | None, theta: float) -> float:
    """Force over weight that holds a rigid block that leans on its toe by θ: moments about the toe."""
    half, alpha = np.hypot(WIDE, HIGH) / 2.0, np.arctan(WIDE / HIGH)
    lever, height = half * np.sin(alpha - theta), half * np.cos(alpha - theta)  # of the centroid
    point = WIDE / 2.0 * np.cos(theta) - HIGH * np.sin(theta)  # of the middle of the top
    held = WEIGHT * lever + PRESS * (point if pressed else lever)
    push = {None: height + HIGH / 2.0, "point": height + HIGH / 2.0 * np.cos(theta), "block": HIGH}[follows]
    return held / push / WEIGHT


@pytest.mark.parametrize(
    ("follows", "dimension", "pressed"),
    [(None, 2, None), ("point", 2, "point"), ("block", 2, "point"), ("block", 3, "point"), ("point", 3, None)],
)
def test_a_block_pushed_over_its_toe(follows, dimension, pressed):
    """What force holds it depends on whether forces go along with their points, and turn with the block."""
    summary, records = solve(pushed(follows, dimension, pressed))
    row = records.rows[-1]
    assert row.monitors[0] == pytest.approx(GO, rel=2e-3)
    theta = abs(row.monitors[1])
    assert row.load == pytest.approx(closed_form(follows, pressed, theta), rel=1e-6)
    other = [closed_form(one, two, theta) for one, two in ((None, None), ("point", "point"), ("block", "point"))]
    assert np.ptp(other) > 1e-2 * row.load  # else the test tells nothing
    assert abs(summary["energy_closure"]) < 1e-5
    if follows == "point":
        assert row.live_displacement == pytest.approx(row.monitors[0], rel=1e-6)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"load": {"at": None}}, "'point' is not used without at or line"),
        ({"load": {"follows": "block"}, "analysis": {"of": None}}, "unless analysis.of names a monitor"),
        ({"analysis": {"kind": "modes"}}, "'point' is not known in kind = 'modes'"),
        ({"material": {"young": 1e9, "deformation": "uniform-strain"}}, "not known beside blocks that deform"),
    ],
)
def test_what_cannot_follow_is_refused(change, said):
    case = pushed("point")
    case["load"][0] |= change.get("load", {})
    case["analysis"] |= change.get("analysis", {})
    case["materials"]["stone"] |= change.get("material", {})
    if case["analysis"]["kind"] == "modes":
        case["analysis"] = {"kind": "modes"}
    for table in (case["load"][0], case["analysis"]):
        for key in [key for key, value in table.items() if value is None]:
            del table[key]
    with pytest.raises(CaseError, match=said):
        scene(case)


@pytest.mark.parametrize("of", [None, "top"])
def test_a_couple_alone_turns_a_block_over_its_toe(of):
    """Two opposite forces: the displacement that is controlled is that of the corners, W R sin(α − θ) holds it."""
    case = pushed(None, pressed=None)
    pull = {"block": "block", "force": [-WEIGHT, 0.0], "at": [0.0, HIGH - 1.0], "kind": "live"}
    case["load"] = [case["load"][0], pull]
    if of is None:
        del case["analysis"]["of"]
    summary, records = solve(case)
    assert summary["status"] == "ok"
    row, radius = records.rows[-1], np.hypot(WIDE, HIGH) / 2.0
    theta = abs(row.monitors[1])
    assert row.load == pytest.approx(radius * np.sin(np.arctan(WIDE / HIGH) - theta), rel=1e-6)
    assert row.live_displacement == pytest.approx(radius * theta, rel=1e-6)
    assert (row.monitors[0] if of else row.live_displacement) == pytest.approx(GO, rel=6e-3)  # a ramp of ten stairs
    assert abs(summary["energy_closure"]) < 1e-5
