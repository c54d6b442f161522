"""Joint properties: from requested joints to stiffness and law of every pair of materials."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.chance import lognormal_factor
from dem_cli.core.contact.block_compliance import BlockCompliance, block_compliance
from dem_cli.core.contact.joints import JointProperties, LawRows
from dem_cli.core.contact.layout import PointLayout
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.laws.friction import FrictionJoint
from dem_cli.core.laws.law import Law
from dem_cli.core.laws.mixed import mixed, row
from dem_cli.core.laws.registry import LAWS
from dem_cli.core.laws.stiffness import StiffJoint
from dem_cli.core.laws.strength import reduced
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import stiffness_scale

if TYPE_CHECKING:
    from dem_cli.core.records.requests import JointRequest, SolverRequest


def laws_of(request: SolverRequest) -> list[Law]:
    """List the laws of all joints, each once, in their order."""
    return list({law.name: law for law in map(_law, request.joints.named.values())}.values())


def law_of(request: SolverRequest) -> Law:
    """Return the law of all joints; where several laws are mixed, one that finds the law of each."""
    return mixed(tuple(laws_of(request)))


def integrates_with(request: SolverRequest, kinematics: str) -> bool:
    """Test whether the pressure on elastic joints is integrated over their faces in this analysis, with these
    kinematics.

    Not where a failure load is sought in geometry of the start: it is that of rigid blocks, and faces close for ever.
    """
    return kinematics != "fixed" or not request.analysis.searches


def joint_properties(
    request: SolverRequest,
    model: Model,
    ratio: float = DEFAULT.stiffness.statics,
    step: float = math.inf,
    lands: bool | None = None,
    integrates: bool = True,
) -> JointProperties:
    """Compute stiffness and law parameters of each named joint; "auto" means kn·h/W = ratio, and ks = kn.

    Blocks of a material with a Young's modulus give way in their joints (contact/block_compliance.py).

    step: time step [s] that velocities in a law refer to; infinite where time has no meaning: all motion is slow.
    lands: whether blocks land on each other, so that joints keep the points at their ends; None: in time histories.
    integrates: whether the pressure on elastic joints is integrated over their faces. Not where blocks land, in any
    case: a face that takes the blow as a whole does not lose what Housner's block does.
    """
    asked = request.joints
    names, by_material, heads = tuple(asked.named), asked.by_material, asked.heads
    lying = _with_heads(model, by_material, heads)
    auto = ratio * stiffness_scale(model)
    laws = laws_of(request)
    tables = list(asked.named.values())
    free = np.array([[table.kn == "auto", table.kn == table.ks == "auto"] for table in tables])
    compliance = block_compliance(model, asked.moduli, free)
    kn = np.array([auto if table.kn == "auto" else table.kn for table in tables])
    ks = np.array([k if table.ks == "auto" else table.ks for table, k in zip(tables, kn, strict=True)])
    rows = [_columns(table, k, step) for table, k in zip(tables, kn, strict=True)]
    width = max(map(len, rows))
    intact = np.zeros((len(names), max(law.scalars for law in laws)))
    for i, table in enumerate(tables):
        values = _law(table).intact
        intact[i, : len(values)] = values
    columns = np.stack([row(laws, _law(table), values, width) for table, values in zip(tables, rows, strict=True)])
    bending = asked.bends
    deforming = _with_deforming_blocks(model, lying, compliance, np.flatnonzero(bending))
    bent = set(lying[:, np.flatnonzero(bending)].ravel().tolist())  # two points cannot tell how a block bends
    lands = request.in_seconds if lands is None else lands
    integrates = integrates and not lands
    integrated = np.array([integrates and table.integrates and k not in bent for k, table in enumerate(tables)])
    layouts = tuple(
        None if integrated[k] and (k in deforming or table.kn != "auto")
        else _layout(table, asked, k in deforming, lands and k not in bent)
        for k, table in enumerate(tables)
    )  # fmt: skip
    spread = [
        (layout is None and _spreads(table)) or table.integrates for layout, table in zip(layouts, tables, strict=True)
    ]
    rigid = free[:, 0] & _with_rigid_blocks(names, model, lying, compliance)
    own_rows = _own_rows(tables, laws, columns, _OfEachJoint(names, step, compliance is not None, asked.seed))
    law = mixed(tuple(laws))
    spreads = np.array(spread) & (model.n_modes == 0)
    return JointProperties(
        names, by_material, kn, ks, columns, intact, layouts, spreads, rigid, law.pressed, law.bonded, integrated,
        compliance, lands, heads, own_rows,
    )  # fmt: skip


def _law(table: StiffJoint) -> Law:
    return LAWS[table.law].of(table)


def _spreads(table: StiffJoint) -> bool:
    """Test whether pressure and friction may act over the face: no points are requested, and no bond holds them."""
    return not table.asks_for_points and not _law(table).bonded


def _layout(table: StiffJoint, asked: JointRequest, deforms: bool, lands: bool) -> PointLayout | None:
    """Return the layout of the contact points of a joint; None: at its two ends, in space at its vertices."""
    if table.profile is not None:
        return PointLayout(seed=asked.seed, **table.profile.ranges)
    points = table.contact_points(asked.dimension, deforms, lands)
    centred = table.centred(asked.dimension, deforms, lands)
    return None if points == 2 and not centred else PointLayout(points, centred)


def _with_deforming_blocks(
    model: Model, lying: np.ndarray, compliance: BlockCompliance | None, bending: np.ndarray
) -> set[int]:
    """Named joints that blocks may have which deform in their joints, or bend by themselves: materials of these.

    Within a stone that can crack: the joint of its pieces, where these deform in it. lying: as `_with_heads`.
    """
    lumped = [] if compliance is None else model.block_material[compliance.deforms]
    found = set(lying[:, np.concatenate([lumped, bending]).astype(int)].ravel().tolist())
    if compliance is None or not len(model.pieces):
        return found
    within = model.pieces[compliance.deforms, 1]
    return found | set(within[within >= 0].tolist())


def _with_rigid_blocks(
    names: Sequence[str], model: Model, lying: np.ndarray, compliance: BlockCompliance | None
) -> np.ndarray:
    """Test whether each named joint may lie between two blocks neither of which deforms, (n_named,) bool.

    lying: as `_with_heads`.
    """
    if compliance is None:
        return np.ones(len(names), bool)
    stiff, free = (np.unique(model.block_material[~compliance.deforms & among]) for among in (True, ~model.fixed))
    within = model.pieces[~compliance.deforms, 1] if len(model.pieces) else model.pieces[:, 1]
    return np.isin(np.arange(len(names)), np.append(lying[:, stiff[:, None], free], within))


def _with_heads(model: Model, by_material: np.ndarray, heads: np.ndarray) -> np.ndarray:
    """Named joints between two materials, (1 or 2, n_materials, n_materials): that of their beds, then that in
    their heads, −1: nothing. Where the model does not distinguish these, the first alone.
    """
    return np.stack([by_material, heads[by_material]] if len(model.courses) else [by_material])


class _OfEachJoint(NamedTuple):
    """Parameters that a law reads of each joint, which two joints of one name need not share."""

    names: tuple[str, ...]  # of the named joints
    step: float  # time step [s] that velocities refer to
    lumped: bool  # whether blocks deform in their joints, so that kn is that of the joint and not of its name
    seed: int  # from which friction is drawn


def _own_rows(
    tables: Sequence[StiffJoint], laws: Sequence[Law], columns: np.ndarray, each: _OfEachJoint
) -> LawRows | None:
    """Build rows of joints whose kn or friction is not that of their name; None: there are none."""
    width, step = columns.shape[1] - (len(laws) > 1), each.step
    hangs = [each.lumped and _columns(table, 1.0, step) != _columns(table, 2.0, step) for table in tables]
    varies = [isinstance(table, FrictionJoint) and table.variation > 0.0 for table in tables]
    own = np.array([a or b for a, b in zip(hangs, varies, strict=True)])
    drawn: dict[tuple[str, ...], StiffJoint] = {}

    def rows(named: np.ndarray, kn: np.ndarray, model: Model, blocks: np.ndarray) -> np.ndarray:
        found = columns[named]
        for k in np.flatnonzero(own[named]):
            number = int(named[k])
            table = tables[number]
            if isinstance(table, FrictionJoint) and varies[number]:
                key = (each.names[number], *sorted(model.block_ids[i] for i in blocks[k]))
                if key not in drawn:
                    drawn[key] = _with_own_friction(table, each.seed, key)
                table = drawn[key]
            found[k] = row(laws, _law(table), _columns(table, float(kn[k]), step), width)
        return found

    return rows if own.any() else None


def _with_own_friction(table: FrictionJoint, seed: int, key: tuple[str, ...]) -> StiffJoint:
    """Draw the friction of one joint into its table; key: names of the joint and of both blocks.

    What the law asks of its strengths among each other goes on to hold (laws/strength.py).
    """
    return reduced(table, 1.0 / lognormal_factor(table.variation, seed, "friction", *key), ("friction",))


def _columns(table: StiffJoint, kn: float, step: float) -> list[float]:
    """Convert the parameters of a joint to columns; velocities as displacement per step."""
    law = _law(table)
    values = list(law.columns(table, kn))
    for column in law.rates:
        values[column] *= step
    return values
