"""Every law through the contact loop, in one and two tangents: plain, compiled and alone the same; the books close."""

from __future__ import annotations

import numpy as np
import pytest
from lawpaths import joint, ramp, through_loop

from dem_cli.core.laws.displacement_path import drive
from dem_cli.core.laws.registry import LAWS

CLOSED, U = -(2.0**-16), 2.0**-15  # N = 32 at CLOSED; friction 0.5 slips at U / 2
BOND = {"tension": 8.0, "cohesion": 20.0}
ENERGIES = {"fracture_energy_tension": 2.0**-13, "fracture_energy_shear": 2.0**-11}
JOINTS = {
    "coulomb": joint("coulomb", friction=0.5),
    "softening": joint("coulomb", friction=0.5, softening={"residual": 0.5, "slip_start": U, "slip_length": 4 * U}),
    "mohr-coulomb": joint("mohr-coulomb", friction=0.5, **BOND),
    "dilating": joint("mohr-coulomb", friction=0.5, **BOND, dilation_deg=15.0, dilation_slip=2 * U),
    "residual": joint("mohr-coulomb", friction=0.5, **BOND, cohesion_residual=9.0, tension_residual=4.0),
    "barton": joint("barton", jrc=10.0, jcs=1e3, residual_angle_deg=25.0),
    "slip-degrading": joint("slip-degrading", friction=0.5, residual=0.5, slip_scale=4 * U),
    "rate-dependent": joint("rate-dependent", {"step": 0.125}, friction=0.5, friction_dynamic=0.25, velocity=U / 2),
    "crushing": joint("crushing", friction=0.5, compression=40.0),
    "fracture": joint("fracture", friction=0.5, **BOND, **ENERGIES, friction_residual=0.25),
    "elastic": joint("elastic"),
}
TARGETS = {
    "sliding": [(CLOSED, 0.0), (CLOSED, 8 * U)],
    "unloading": [(CLOSED, 0.0), (CLOSED, 4 * U), (CLOSED, 3.75 * U)],
    "to and fro": [(CLOSED, 0.0), (CLOSED, 4 * U), (CLOSED, -4 * U), (CLOSED, 4 * U)],
    "pressing while sliding": [(CLOSED, 0.0), (8 * CLOSED, 4 * U), (CLOSED, 8 * U), (4 * CLOSED, 0.0)],
    "opening": [(-CLOSED, 0.0), (0.0, 0.0), (CLOSED, 0.0), (0.0, 0.0), (-4 * CLOSED, 0.0)],
    "opening while sliding": [(CLOSED, 0.0), (CLOSED, U / 8), (0.0, U / 8), (-CLOSED, 4 * U), (0.0, 4 * U),
                              (CLOSED, 4 * U), (CLOSED, -4 * U)],
}  # fmt: skip
PATHS = {
    2: {name: ramp(*rows) for name, rows in TARGETS.items()},
    3: {name: ramp(*[(gap, u, u / 2) for gap, u in rows]) for name, rows in TARGETS.items()}
    | {"around a corner": ramp((CLOSED, 0.0, 0.0), (CLOSED, 4 * U, 0.0), (CLOSED, 4 * U, 4 * U), (CLOSED, 0.0, 0.0))},
}
each_joint = pytest.mark.parametrize("name", JOINTS)
each_dimension = pytest.mark.parametrize("d", [2, 3])


def test_every_law_is_here():
    assert set(LAWS) <= set(JOINTS)


@each_dimension
@each_joint
def test_loop_law_and_compiled_loop_agree(name, d):
    """To the last bit, for points that touch at the start and for those that meet later."""
    law = JOINTS[name]
    for path in PATHS[d].values():
        for touches in (True, False):
            compiled, plain = (through_loop([law], path, compiled=c, touches=touches) for c in (True, False))
            alone = drive(law.law, law.table, path, touches=touches, **law.stiffness)
            for a, b in zip(compiled, plain, strict=True):
                assert np.array_equal(a, b)
            assert np.array_equal(compiled.normal[:, 0], alone.normal)
            assert np.array_equal(compiled.shear[:, 0], alone.shear)
            assert np.array_equal(compiled.lost, alone.lost)
            assert np.array_equal(compiled.memory[0], alone.memory[-1])


@each_dimension
@each_joint
def test_work_is_elastic_energy_and_what_is_lost(name, d):
    """To round-off; where a dilated, crushed or slack point opens or closes in a step, to its force × half the step."""
    law = JOINTS[name]
    for title, path in PATHS[d].items():
        done = drive(law.law, law.table, path, **law.stiffness)
        within = 0.0
        if name in ("dilating", "crushing", "residual"):
            events = np.diff((done.normal != 0.0).astype(int)) != 0
            forces = np.abs(done.normal)
            within = (0.5 * np.maximum(forces[1:], forces[:-1]) * np.abs(np.diff(path[:, 0])))[events].sum()
        wrong = done.external[-1] - done.elastic[-1] - done.lost[-1]
        assert abs(wrong) <= within + 1e-12 * np.abs(done.external).max(), title


@each_dimension
@each_joint
def test_nothing_is_won(name, d):
    """What is lost only grows, but for what a crack gives back along its secant, and never below zero."""
    law = JOINTS[name]
    for path in PATHS[d].values():
        lost = drive(law.law, law.table, path, **law.stiffness).lost
        assert lost.min() >= 0.0
        if name not in ("fracture", "residual"):
            assert np.diff(lost).min() >= -1e-12 * lost[-1]


@each_joint
def test_planar_twin(name):
    """A plane path in space gives the plane forces, the third ones are zero."""
    law = JOINTS[name]
    for path in PATHS[2].values():
        plane = drive(law.law, law.table, path, **law.stiffness)
        space = drive(law.law, law.table, np.column_stack([path, np.zeros(len(path))]), **law.stiffness)
        np.testing.assert_allclose(space.normal, plane.normal, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(space.shear[:, 0], plane.shear[:, 0], rtol=1e-12, atol=1e-12)
        assert not space.shear[:, 1].any()


@each_joint
def test_shear_stays_below_the_limit_that_is_reported(name):
    """`shear_limit`, which pictures and records use, is the law's own: reached where a point slips, never passed."""
    law = JOINTS[name]
    for path in PATHS[2].values():
        done = drive(law.law, law.table, path, **law.stiffness)
        columns = np.tile(law.columns, (len(path), 1))
        limit = law.law.shear_limit(columns, done.normal, done.memory, np.full(len(path), law.kn * law.area))
        carries = done.normal != 0.0
        force = np.abs(done.shear[carries, 0])
        assert np.all(force <= limit[carries] * (1 + 1e-9) + 1e-7)  # 1e-9 of the strength is none
        slips = (np.diff(done.slip, prepend=0.0) > 1e-12)[carries]
        np.testing.assert_allclose(force[slips], limit[carries][slips], rtol=1e-9, atol=1e-7)


@each_joint
def test_a_new_point_holds_what_the_law_finds_at_its_gap(name):
    """`pressed`, of points that come to be with the memory of others: the force wherever a path stops for a step."""
    law = JOINTS[name]
    for title, path in PATHS[3].items():
        path = np.repeat(path[::4], 4, axis=0)
        for touches in (True, False):
            done = drive(law.law, law.table, path, touches=touches, **law.stiffness)
            rows, kn = np.tile(law.columns, (len(path), 1)), np.full(len(path), law.kn * law.area)
            found = law.law.pressed(rows, -path[:, 0], done.memory, kn)
            np.testing.assert_allclose(
                found[3::4], done.normal[3::4], atol=1e-12 * law.kn * U, err_msg=f"{title} {touches}"
            )
