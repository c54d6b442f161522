"""Buckling: a straight column on elastic joints stands below its load of buckling, above it forces only balance."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, simulation, solve, tables
from scipy.linalg import eigvalsh
from scipy.sparse import csr_array, diags_array

from dem_cli.core.arithmetic.sparse_systems import SymmetricFactors, most_negative
from dem_cli.core.dynamics.stability import buckles
from dem_cli.core.engine.budget import Budget
from dem_cli.core.statics.equilibrium import stand

SIDE, KN, DENSITY = 0.3, 1e9, 100.0


def critical(n: int) -> float:
    """Load on top that makes n blocks buckle [N]: rigid links on springs kn b³/12, with their weights."""
    spring, weight = KN * SIDE**3 / 12.0, DENSITY * 9.81 * SIDE**2
    stiffness, levers = np.zeros((n, n)), SIDE * np.eye(n)
    for i in range(n):
        stiffness[i, i] += spring
        if i:
            stiffness[i - 1, i - 1] += spring
            stiffness[i, i - 1] = stiffness[i - 1, i] = -spring
    by_weight = np.diag(weight * SIDE * (np.arange(n)[::-1] + 0.5))
    return float(eigvalsh(stiffness - by_weight, levers)[0])


def column(n: int, load: float, law: str = "coulomb", load_kind: str = "dead", **analysis) -> dict:
    """Blocks of 0.3 m on each other, pressed in the middle of the top by a load that goes along with it."""
    strength = {"friction": 1.0} if law == "coulomb" else {"law": law}
    joint = strength | {"kn": KN, "ks": 100.0 * KN}
    base = block("base", rectangle(-1.0, -0.3, 1.3, 0.0), fixed=True)
    blocks = [block(f"b{i}", rectangle(0.0, SIDE * i, SIDE, SIDE * (i + 1))) for i in range(n)]
    force = [
        {"block": f"b{n - 1}", "force": [0.0, -load], "at": [SIDE / 2, SIDE * n], "follows": "point", "kind": load_kind}
    ]
    return tables(
        base, *blocks, density=DENSITY, joints={"j": joint}, load=force,
        analysis={"kind": "gravity", "kinematics": "large"} | analysis,
    )  # fmt: skip


@pytest.mark.parametrize("law", ["coulomb", "elastic"])
@pytest.mark.parametrize(("share", "status"), [(0.4, "ok"), (0.96, "ok"), (1.04, "buckled under its dead loads")])
def test_a_straight_column_buckles_above_its_load(share, status, law):
    summary, _ = solve(column(6, share * critical(6), law))
    assert summary["status"] == status
    assert summary.get("buckling") == (None if status == "ok" else {"block": "b5"})


@pytest.mark.parametrize("control", ["load", "displacement"])
def test_a_load_that_makes_a_column_buckle_is_found(control):
    """Nothing pushes it sideways: without the tangent the load rises for ever."""
    exact = critical(3)
    how = {"kind": "pushover", "pattern": "live", "max_load": 4.0, "resolution": 0.01}
    how |= {"control": control, "follow": 3.0 * exact / (KN * SIDE)} if control == "displacement" else {}
    summary, _ = solve(column(3, exact, load_kind="live", **how))
    assert summary["status"] == "ok"
    low, high = summary["failure_load_bracket"]
    assert 0.97 < low <= high < 1.03
    assert summary["proof_of_failure"]["by"] == "buckling"


def test_a_path_of_loads_ends_where_it_buckles():
    case = column(3, critical(3), load_kind="live") | {"analysis": {
        "kind": "cycle", "pattern": "live", "path": [0.9, 1.1], "step": 0.3, "kinematics": "large",
    }}  # fmt: skip
    summary, _ = solve(case)
    assert summary["status"] == "fails on the way"
    assert summary["failure_load"] == pytest.approx(1.1)


def test_what_was_looked_at_stays_as_it_was():
    sim = simulation(column(4, 1.2 * critical(4)), "large")
    assert stand(sim, Budget(100_000)).state == "equilibrium"
    before = sim.bodies.positions.copy()
    assert buckles(sim, Budget(100_000)) is not None
    assert np.array_equal(sim.bodies.positions, before)


def test_geometry_of_the_start_and_stiff_joints_are_not_asked():
    """The stiffness of an "auto" joint says nothing of buckling, and frozen geometry does not buckle."""
    fixed = simulation(column(3, 2.0 * critical(3)), "fixed")
    stand(fixed, Budget(100_000))
    assert buckles(fixed, Budget(0)) is None


def test_the_lowest_eigenvector_where_it_is_negative():
    """Eigenvalues 2 − 2 cos(kπ/(n + 1)), less 0.05, of which the first ones are negative; shapes are sines."""
    n = 20
    matrix = csr_array(diags_array([-np.ones(n - 1), np.full(n, 1.95), -np.ones(n - 1)], offsets=[-1, 0, 1]))
    exact = np.linalg.eigvalsh(matrix.toarray())
    assert SymmetricFactors(matrix).negative == (exact < 0.0).sum() == 1
    sine = np.sin(np.arange(1, n + 1) * np.pi / (n + 1))
    found = most_negative(matrix, 1e-9)
    assert abs(found @ sine) == pytest.approx(np.linalg.norm(sine), rel=1e-4)
    assert most_negative(matrix, 0.05) is None
