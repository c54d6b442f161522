"""What holds on every path, whatever its steps: the limit surface, and that nothing is won."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lawpaths import joint

from dem_cli.core.laws.decay import slip_on_decay
from dem_cli.core.laws.displacement_path import drive
from dem_cli.core.laws.mohr_coulomb import slip_while_dilating

U = 1e-5
BOND = {"tension": 8.0, "cohesion": 20.0}
ENERGIES = {"fracture_energy_tension": 1e-4, "fracture_energy_shear": 5e-4}
JOINTS = [
    joint("coulomb", friction=0.5),
    joint("coulomb", friction=0.5, softening={"residual": 0.5, "slip_start": U, "slip_length": 3 * U}),
    joint("mohr-coulomb", friction=0.5, **BOND, cohesion_residual=9.0, friction_residual=0.4),
    joint("mohr-coulomb", friction=0.5, dilation_deg=20.0, dilation_slip=4 * U),
    joint("barton", jrc=10.0, jcs=1e3, residual_angle_deg=25.0),
    joint("slip-degrading", friction=0.5, residual=0.3, slip_scale=3 * U),
    joint("rate-dependent", {"step": 0.1}, friction=0.5, friction_dynamic=0.2, velocity=10 * U),
    joint("crushing", friction=0.5, compression=30.0),
    joint("fracture", friction=0.5, **BOND, **ENERGIES, friction_residual=0.25),
]
number = st.floats(-5 * U, 5 * U, allow_subnormal=False)
paths = st.one_of(
    st.lists(st.tuples(number, number), min_size=2, max_size=25),
    st.lists(st.tuples(number, number, number), min_size=2, max_size=25),
)
by_law = pytest.mark.parametrize("law", JOINTS, ids=lambda j: j.law.name)


@by_law
@settings(max_examples=60, deadline=None)
@given(path=paths, touches=st.booleans())
def test_never_beyond_the_limit_surface(law, path, touches):
    done = drive(law.law, law.table, path, touches=touches, **law.stiffness)
    columns = np.tile(law.columns, (len(path), 1))
    limit = law.law.shear_limit(columns, done.normal, done.memory, np.full(len(path), law.kn * law.area))
    carries = done.normal != 0.0
    size = np.linalg.norm(done.shear, axis=1)
    assert np.all(size[carries] <= limit[carries] * (1 + 1e-9) + 1e-7)
    pull = getattr(law.table, "tension", 0.0) if touches else 0.0
    assert done.normal.min() >= -pull * law.area * (1 + 1e-12)
    if law.law.name == "crushing":
        assert done.normal.max() <= law.table.compression * law.area * (1 + 1e-12)


@by_law
@settings(max_examples=60, deadline=None)
@given(path=paths)
def test_nothing_is_won(law, path):
    """What the springs do not keep is against the force that a step ends with; a crack in tension has its secant."""
    done = drive(law.law, law.table, path, **law.stiffness)
    path = np.asarray(path)
    moved = np.diff(path, axis=0, prepend=0.0)
    opened = moved[:, 0] + np.diff(done.normal, prepend=0.0) / law.kn
    slipped = moved[:, 1:] + np.diff(done.shear, axis=0, prepend=0.0) / law.ks
    lost = -(done.shear * slipped).sum(axis=1) - done.normal * opened
    if law.law.name == "fracture":
        assert np.all(np.diff(done.memory, axis=0, prepend=[[1.0, 0.0]])[:, 0] <= 0.0)
        assert np.all(np.diff(done.memory, axis=0)[:, 1] >= 0.0)
        lost = lost[done.normal >= 0.0]
    assert lost.min(initial=0.0) >= -1e-12 * (1e-9 + np.abs(done.external).max())


@by_law
@settings(max_examples=40, deadline=None)
@given(path=st.lists(st.tuples(st.floats(-5 * U, -U), number, number), min_size=2, max_size=25))
def test_books_close_while_it_is_pressed(law, path):
    """To round-off, whatever the steps; paths on which a crushed or sunk point opens are left out."""
    done = drive(law.law, law.table, [(-U, 0.0, 0.0), *path], **law.stiffness)
    if done.normal.min() > 0.0:
        wrong = np.abs(done.external - done.elastic - done.lost)
        assert wrong.max() <= 1e-11 * np.abs(done.external).max()


@settings(max_examples=300, deadline=None)
@given(
    start=st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)), angle=st.floats(0.0, 6.3), reach=st.floats(0.01, 3.0),
    ks=st.floats(0.1, 10.0), grip=st.floats(0.01, 10.0), above=st.floats(1e-3, 10.0),
)  # fmt: skip
def test_slip_while_dilating_is_the_first_root(start, angle, reach, ks, grip, above):
    away = (np.cos(angle), np.sin(angle))

    def excess(x):
        place = np.array(start) + np.multiply.outer(x, away)
        return force - ks * x - grip * np.minimum(np.linalg.norm(place, axis=-1), reach)

    force = grip * min(np.hypot(*start), reach) + above
    x = slip_while_dilating(start, away, reach, force, ks, grip)
    scale = force + ks * x + grip * (np.hypot(*start) + x)
    assert x > 0.0
    assert abs(excess(x)) <= 1e-9 * scale
    before = np.linspace(0.0, x, 400)
    assert excess(before).min() >= -1e-9 * scale


@settings(max_examples=300, deadline=None)
@given(
    stiffness=st.floats(1e-3, 1e3), floor=st.floats(-1.0, 1.0), drop=st.floats(0.0, 10.0), rate=st.floats(0.0, 1e6),
    above=st.floats(1e-9, 10.0),
)  # fmt: skip
def test_slip_on_decay_is_a_root(stiffness, floor, drop, rate, above):
    force = floor + drop + above
    x = slip_on_decay(force, stiffness, floor, drop, rate)
    assert x > 0.0
    assert force - stiffness * x == pytest.approx(
        floor + drop * np.exp(-rate * x), abs=1e-9 * (abs(force) + drop + 1.0)
    )
