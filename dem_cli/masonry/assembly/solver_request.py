"""Collect what the solvers need to know of a case, independent of its tables."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.core.records.requests import (
    DEFAULT_FRACTION,
    AnalysisRequest,
    DampingRequest,
    InitialRequest,
    JointRequest,
    MaxwellRequest,
    MonitorRequest,
    RayleighRequest,
    ShakingRequest,
    SolverRequest,
)
from dem_cli.masonry.assembly.assemble import joint_table, joints_in_heads

if TYPE_CHECKING:
    from dem_cli.case.schema import Case, Monitor
    from dem_cli.case.tables.damping import DampingTable, RayleighDamping
    from dem_cli.case.tables.initial_state import InitialState


def solver_request(case: Case) -> SolverRequest:
    """Create the solver request of a case: joints, analysis, gravity, damping and supports."""
    return SolverRequest(
        joints=_joints(case),
        analysis=_analysis(case.analysis),
        gravity=case.gravity,
        imperfect=bool(case.imperfection),
        damping=_damping(case.damping),
        initial=tuple(map(_initial, case.initial)),
        monitors=tuple(map(_monitor, case.monitor)),
        snapshots=case.output.snapshots,
        frames=case.output.frames,
        rate=case.output.rate,
    )


def _joints(case: Case) -> JointRequest:
    materials = case.materials.values()
    uniform = [one.young if one.strains and not one.bends else math.inf for one in materials]
    return JointRequest(
        {name: table.alone for name, table in case.joints.items()},
        joint_table(case)[1],
        joints_in_heads(case),
        np.array([one.moduli for one in materials]),
        np.array(uniform, float),
        np.array([one.bends for one in materials]),
        case.dimension,
        case.seed,
    )


def _analysis(table: Any) -> AnalysisRequest:
    searches = table.kind == "pushover" and table.control == "load"
    common = {
        "kinematics": table.kinematics,
        "max_steps": table.max_steps,
        "resolution": getattr(table, "resolution", None),
        "tilting": getattr(table, "pattern", None) == "tilt",
        "searches": searches,
        "start": getattr(table, "start", "auto"),
        "step": getattr(table, "step", None),
    }
    if not hasattr(table, "margin"):
        return AnalysisRequest(**common)
    keys = ("margin", "time_step", "duration", "settle", "fallen_deg", "dropped", "coda")
    return ShakingRequest(
        **common,
        **{key: getattr(table, key) for key in keys},
        free_step=table.time_step is None and table.margin == type(table).model_fields["margin"].default,
        after_collapse=getattr(table, "after_collapse", 0.0),
    )


def _damping(table: DampingTable | None) -> DampingRequest:
    if table is None:
        return DampingRequest(contact_fraction=DEFAULT_FRACTION)
    return DampingRequest(
        table.contact_fraction or 0.0,
        table.restitution,
        table.block,
        None if table.rayleigh is None else _rayleigh(table.rayleigh),
        table.stiffness or 0.0,
        table.mass or 0.0,
        tuple(MaxwellRequest(one.ratio, one.frequency) for one in table.maxwell or ()),
        table.local or 0.0,
    )


def _rayleigh(table: RayleighDamping) -> RayleighRequest:
    mass, stiffness = table.coefficients()
    return RayleighRequest(table.ratio, mass, stiffness, table.frequencies is not None)


def _initial(table: InitialState) -> InitialRequest:
    return InitialRequest(table.names, table.turn, table.displacement, table.velocity)


def _monitor(table: Monitor) -> MonitorRequest:
    return MonitorRequest(
        table.quantity,
        table.component,
        table.absolute,
        table.tie or table.bar,
        table.at or 0.0,
        table.selected,
        table.between,
        table.point,
        table.cut,
        table.height,
    )
