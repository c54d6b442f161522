"""Joint properties: from the [joints] of a case to stiffness and law of every pair of materials."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.assembly.assemble import joint_table
from dem_cli.contact.joints import JointProperties
from dem_cli.contact.layout import PointLayout
from dem_cli.engine.settings import DEFAULT
from dem_cli.laws.law import Law
from dem_cli.laws.mixed import mixed, row
from dem_cli.laws.registry import LAWS
from dem_cli.laws.stiffness import StiffJoint
from dem_cli.model.model import Model
from dem_cli.model.scales import stiffness_scale

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


def laws_of(case: Case) -> list[Law]:
    """The laws of all joints, each once, in the order of the case."""
    return list({law.name: law for law in map(_law, case.joints.values())}.values())


def law_of(case: Case) -> Law:
    """The law of all joints; where the case mixes laws, one that finds the law of each."""
    return mixed(tuple(laws_of(case)))


def joint_properties(
    case: Case, model: Model, ratio: float = DEFAULT.stiffness.statics, step: float = math.inf
) -> JointProperties:
    """Stiffness and law parameters of each named joint; "auto" means kn·h/W = ratio, and ks = kn.

    step: time step [s] that velocities in a law refer to; infinite where time has no meaning: all motion is slow.
    """
    names, by_material = joint_table(case)
    auto = ratio * stiffness_scale(model)
    laws = laws_of(case)
    tables = [case.joints[name] for name in names]
    kn = np.array([auto if table.kn == "auto" else table.kn for table in tables])
    ks = np.array([k if table.ks == "auto" else table.ks for table, k in zip(tables, kn, strict=True)])
    rows = [_columns(table, k, step) for table, k in zip(tables, kn, strict=True)]
    width = max(map(len, rows))
    intact = np.zeros((len(names), max(law.scalars for law in laws)))
    for i, table in enumerate(tables):
        values = _law(table).intact
        intact[i, : len(values)] = values
    columns = np.stack([row(laws, _law(table), values, width) for table, values in zip(tables, rows, strict=True)])
    layouts = tuple(_layout(table, case.seed, model.dimension) for table in tables)
    rigid = np.array([table.kn == "auto" for table in tables])
    return JointProperties(names, by_material, kn, ks, columns, intact, layouts, rigid, mixed(tuple(laws)).pressed)


def _law(table: StiffJoint) -> Law:
    return LAWS[table.law].of(table)


def _layout(table: StiffJoint, seed: int, dimension: int) -> PointLayout | None:
    """Where the contact points of a joint are; None: at its two ends, in space at its vertices."""
    if table.profile is not None:
        return PointLayout(seed=seed, **table.profile.ranges)
    points = table.contact_points(dimension)
    return None if points == 2 and not table.centred else PointLayout(points, table.centred)


def _columns(table: StiffJoint, kn: float, step: float) -> list[float]:
    """Parameters of a joint; velocities as displacement per step."""
    law = _law(table)
    values = list(law.columns(table, kn))
    for column in law.rates:
        values[column] *= step
    return values
