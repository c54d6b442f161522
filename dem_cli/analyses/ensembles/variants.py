"""Perturbed structures for the sensitivity of results to small errors, drawn from the seed of the case.

Joints stay closed as drawn: gaps would change the structure, not perturb it ([[imperfection]] makes those). An error of
size ε of a block changes its mass, and moves its centre of mass against its joints, by that share; both are done to
the masses alone. That a structure stands out of plumb is done to the direction of gravity.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.geometry.rotation import moments
from dem_cli.core.laws.friction import FrictionJoint
from dem_cli.core.model.first_moments import first_moments
from dem_cli.core.model.model import Model

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.case.tables.analysis import Perturbation

STREAM = 0xD1FF  # so that no other draws from the same seed are met


class Variant:
    """Perturbed variant of a structure: number 0 is the one of the case, the others differ from it.

    case, model  with its own joints and masses
    motion       factor on the ground motion
    largest      standard deviations that a draw is limited to
    """

    def __init__(self, case: Case, model: Model, number: int, largest: float = DEFAULT.statistics.largest_draw):
        self.number, self.case, self.model, self.motion = number, case, model, 1.0
        if number == 0:
            return
        perturb: Perturbation = case.analysis.perturb
        friction, geometry, motion = (np.random.default_rng([case.seed, STREAM, number, topic]) for topic in range(3))
        self.case = _other_friction(case, perturb.friction, friction, largest)
        self.model = other_sizes(model, case.gravity, perturb.geometry, geometry, largest)
        self.motion = 1.0 + float(_draw(motion, perturb.motion, (1,), largest)[0])


def _draw(generator: np.random.Generator, deviation: float, shape: tuple[int, ...], largest: float) -> np.ndarray:
    """Draw truncated normal errors."""
    return deviation * np.clip(generator.standard_normal(shape), -largest, largest)


def _other_friction(case: Case, deviation: float, generator: np.random.Generator, largest: float) -> Case:
    """Scale the friction coefficient of each named joint by a random factor."""
    joints = {}
    for (name, joint), error in zip(
        case.joints.items(), _draw(generator, deviation, (len(case.joints),), largest), strict=True
    ):
        if isinstance(joint, FrictionJoint):
            factor = 1.0 + float(error)
            joint = joint.with_values(friction=factor * joint.coefficient, friction_angle_deg=None)
        joints[name] = joint
    return case.model_copy(update={"joints": joints})


def other_sizes(
    model: Model,
    gravity: float,
    deviation: float,
    generator: np.random.Generator,
    largest: float = DEFAULT.statistics.largest_draw,
) -> Model:
    """Perturb masses, centres of mass and direction of gravity; the corners of blocks stay in place.

    deviation: relative, of masses, of the distances of the corners along each axis, and of the lean [rad].
    """
    d, n = model.dimension, model.n_blocks
    errors = np.where(model.fixed[:, None], 0.0, _draw(generator, deviation, (n, 1 + d), largest))
    lean = _draw(generator, deviation, (d - 1,), largest)
    factors = 1.0 + errors[:, 0]
    owner = model.vertex_blocks
    first = np.searchsorted(owner, np.arange(n))
    sizes = np.maximum.reduceat(model.vertices, first) - np.minimum.reduceat(model.vertices, first)
    shifts = 0.5 * errors[:, 1:] * sizes
    weights = np.zeros((n, d))
    weights[:, -1] = -gravity * model.masses
    dead = model.dead_loads.copy()
    dead[:, :d] -= weights  # what is left are point loads, which act where they did
    dead[:, model.rotations] -= moments(shifts, dead[:, :d])
    at_points = model.dead_first_moments
    if len(at_points):
        at_points = at_points - first_moments(shifts, dead[:, :d])
    dead[:, d - 1] += factors * weights[:, -1]
    dead[:, : d - 1] += factors[:, None] * weights[:, -1:] * lean
    return model._replace(
        masses=factors * model.masses,
        inertias=factors[:, None] * model.inertias,
        centroids=model.centroids + shifts,
        vertices=model.vertices - shifts[owner],
        dead_loads=dead,
        dead_first_moments=at_points,
        following=model.following and model.following.shifted(shifts),
    )
