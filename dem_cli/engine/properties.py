"""Joint properties: from the [joints] of a case to stiffness and law of every pair of materials."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.assembly.assemble import joint_table
from dem_cli.contact.block_compliance import BlockCompliance, block_compliance
from dem_cli.contact.joints import JointProperties, LawRows
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
    case: Case,
    model: Model,
    ratio: float = DEFAULT.stiffness.statics,
    step: float = math.inf,
    lands: bool | None = None,
) -> JointProperties:
    """Stiffness and law parameters of each named joint; "auto" means kn·h/W = ratio, and ks = kn.

    Blocks of a material with a Young's modulus give way in their joints (contact/block_compliance.py).

    step: time step [s] that velocities in a law refer to; infinite where time has no meaning: all motion is slow.
    lands: whether blocks land on each other, so that joints keep the points at their ends; None: in time histories.
    """
    names, by_material = joint_table(case)
    auto = ratio * stiffness_scale(model)
    laws = laws_of(case)
    tables = [case.joints[name] for name in names]
    free = np.array([[table.kn == "auto", table.kn == table.ks == "auto"] for table in tables])
    compliance = block_compliance(model, np.array([m.moduli for m in case.materials.values()]), free)
    kn = np.array([auto if table.kn == "auto" else table.kn for table in tables])
    ks = np.array([k if table.ks == "auto" else table.ks for table, k in zip(tables, kn, strict=True)])
    rows = [_columns(table, k, step) for table, k in zip(tables, kn, strict=True)]
    width = max(map(len, rows))
    intact = np.zeros((len(names), max(law.scalars for law in laws)))
    for i, table in enumerate(tables):
        values = _law(table).intact
        intact[i, : len(values)] = values
    columns = np.stack([row(laws, _law(table), values, width) for table, values in zip(tables, rows, strict=True)])
    bending = [table.bends for table in case.materials.values()]
    deforming = _with_deforming_blocks(model, by_material, compliance, np.flatnonzero(bending))
    bent = set(by_material[np.flatnonzero(bending)].ravel().tolist())  # two points cannot tell how a block bends
    lands = hasattr(case.analysis, "margin") if lands is None else lands
    integrated = np.array([_integrates(table) and k not in bent for k, table in enumerate(tables)])
    layouts = tuple(
        None if integrated[k] and (k in deforming or table.kn != "auto")
        else _layout(table, case, k in deforming, lands and k not in bent)
        for k, table in enumerate(tables)
    )  # fmt: skip
    rigid = free[:, 0] & _with_rigid_blocks(names, model, by_material, compliance)
    own_rows = None if compliance is None else _own_rows(tables, laws, columns, step)
    law = mixed(tuple(laws))
    return JointProperties(
        names, by_material, kn, ks, columns, intact, layouts, rigid, law.pressed, law.bonded, integrated, compliance,
        own_rows,
    )  # fmt: skip


def _law(table: StiffJoint) -> Law:
    return LAWS[table.law].of(table)


def _integrates(table: StiffJoint) -> bool:
    """Whether the pressure on an elastic joint is integrated: a plane one, without tension or points of its own."""
    return table.points is None and table.profile is None and not _law(table).bonded


def _layout(table: StiffJoint, case: Case, deforms: bool, lands: bool) -> PointLayout | None:
    """Where the contact points of a joint are; None: at its two ends, in space at its vertices."""
    if table.profile is not None:
        return PointLayout(seed=case.seed, **table.profile.ranges)
    points = table.contact_points(case.dimension, deforms, lands)
    centred = table.centred(case.dimension, deforms, lands)
    return None if points == 2 and not centred else PointLayout(points, centred)


def _with_deforming_blocks(
    model: Model, by_material: np.ndarray, compliance: BlockCompliance | None, bending: np.ndarray
) -> set[int]:
    """Named joints that blocks may have which deform in their joints, or bend by themselves: materials of these.

    Within a stone that can crack: the joint of its pieces, where these deform in it.
    """
    lumped = [] if compliance is None else model.block_material[compliance.deforms]
    found = set(by_material[np.concatenate([lumped, bending]).astype(int)].ravel().tolist())
    if compliance is None or not len(model.pieces):
        return found
    within = model.pieces[compliance.deforms, 1]
    return found | set(within[within >= 0].tolist())


def _with_rigid_blocks(
    names: Sequence[str], model: Model, by_material: np.ndarray, compliance: BlockCompliance | None
) -> np.ndarray:
    """Whether each named joint may lie between two blocks neither of which deforms, (n_named,) bool."""
    if compliance is None:
        return np.ones(len(names), bool)
    stiff, free = (np.unique(model.block_material[~compliance.deforms & among]) for among in (True, ~model.fixed))
    within = model.pieces[~compliance.deforms, 1] if len(model.pieces) else model.pieces[:, 1]
    return np.isin(np.arange(len(names)), np.append(by_material[np.ix_(stiff, free)], within))


def _own_rows(tables: Sequence[StiffJoint], laws: Sequence[Law], columns: np.ndarray, step: float) -> LawRows | None:
    """Rows of joints whose kn is not that of their name; None: no law hangs on it."""
    width = columns.shape[1] - (len(laws) > 1)
    hangs = [_columns(table, 1.0, step) != _columns(table, 2.0, step) for table in tables]

    def rows(named: np.ndarray, kn: np.ndarray) -> np.ndarray:
        found = columns[named]
        for k in np.flatnonzero(np.array(hangs)[named]):
            table = tables[named[k]]
            found[k] = row(laws, _law(table), _columns(table, float(kn[k]), step), width)
        return found

    return rows if any(hangs) else None


def _columns(table: StiffJoint, kn: float, step: float) -> list[float]:
    """Parameters of a joint; velocities as displacement per step."""
    law = _law(table)
    values = list(law.columns(table, kn))
    for column in law.rates:
        values[column] *= step
    return values
