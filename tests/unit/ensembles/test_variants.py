"""Slightly different structures: what changes, and what does not."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.analyses.ensembles.variants import Variant, other_sizes
from dem_cli.app import api
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.model.places import undeformed

CASE = """\
[materials.stone]
density = 2000.0
[joints.dry]
friction_angle_deg = 30.0
[joints.other]
friction = 0.7
[[structure]]
kind = "column"
id = "c"
courses = 3
block = [0.5, 0.5]
[[load]]
block = "c-3"
force = [30.0, -100.0]
at = [0.1, 1.4]
[analysis]
kind = "time-history"
duration = 1.0
repeats = 2
"""


@pytest.fixture
def built(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE, encoding="utf-8")
    loaded = api.load_case(path)
    return loaded.case, api.build_model(loaded)


def moments(model, forces):
    """About the origin, of forces at centroids and moments, 2D."""
    x, y = model.centroids.T
    return x * forces[:, 1] - y * forces[:, 0] + forces[:, 2]


def test_the_first_is_the_structure_of_the_case(built):
    case, model = built
    first = Variant(case, model, 0)
    assert first.case is case
    assert first.model is model
    assert first.motion == 1.0


def test_joints_stay_where_they_are_and_supports_what_they_are(built):
    case, model = built
    other = Variant(case, model, 1).model
    assert undeformed(other) == pytest.approx(undeformed(model), abs=1e-15)
    fixed = model.fixed
    assert np.array_equal(other.centroids[fixed], model.centroids[fixed])
    assert not (other.centroids[~fixed] == model.centroids[~fixed]).any()
    assert (other.masses[~fixed] != model.masses[~fixed]).all()


def test_errors_are_as_large_as_was_asked_for(built):
    _, model = built
    draws = [other_sizes(model, 9.81, 0.01, np.random.default_rng(k)) for k in range(400)]
    free = ~model.fixed
    masses = np.array([m.masses[free] / model.masses[free] - 1.0 for m in draws])
    shifts = np.array([(m.centroids - model.centroids)[free] for m in draws])
    leans = np.array([m.dead_loads[free, 0].sum() - 30.0 for m in draws]) / (9.81 * model.masses[free].sum())
    assert masses.std() == pytest.approx(0.01, rel=0.1)
    assert np.abs(masses).max() <= DEFAULT.statistics.largest_draw * 0.01 + 1e-15
    assert shifts.std() == pytest.approx(0.01 * 0.25, rel=0.1)
    assert leans.std() == pytest.approx(0.01, rel=0.15)


def test_point_loads_act_where_they_did(built):
    _, model = built
    other = other_sizes(model, 9.81, 0.01, np.random.default_rng(3))
    weightless = model.dead_loads - _weights(model)
    lean = -(other.dead_loads[:, 0] - weightless[:, 0]) / (9.81 * other.masses)
    point = other.dead_loads.copy()
    point[:, 1] += 9.81 * other.masses
    point[:, 0] += lean * 9.81 * other.masses
    assert point[:, :2] == pytest.approx(weightless[:, :2], abs=1e-9)
    assert moments(other, point) == pytest.approx(moments(model, weightless), abs=1e-9)


def _weights(model):
    weights = np.zeros((model.n_blocks, 3))
    weights[:, 1] = -9.81 * model.masses
    return weights


def test_friction_of_each_joint_is_drawn_from_the_seed(built):
    case, model = built
    one, again, two = (Variant(case, model, k) for k in (1, 1, 2))
    factors = [v.case.joints[n].coefficient / case.joints[n].coefficient for v in (one, two) for n in case.joints]
    assert len(set(factors)) == 4
    assert all(0.94 <= factor <= 1.06 for factor in factors)
    assert one.case.joints["dry"].coefficient == again.case.joints["dry"].coefficient
    assert np.array_equal(one.model.masses, again.model.masses)
    assert one.motion == again.motion != two.motion
