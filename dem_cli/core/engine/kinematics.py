"""Kinematics of a run: whether large displacements matter before failure, and the scale of its live loads."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.contact.gaps import gap_words, gaps_of_start, wedges_of_start
from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.engine.properties import joint_properties
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import smallest_edge, structures
from dem_cli.errors import CaseError, CaseProblem

if TYPE_CHECKING:
    from dem_cli.core.records.requests import SolverRequest


def why_moving(request: SolverRequest, model: Model) -> str | None:
    """Return the reason for large displacements before failure ("": requested); None: the initial geometry is good
    enough.

    Raises CaseError where fixed geometry is requested that joints do not allow.
    """
    wanted = request.analysis.kinematics
    profiles = [name for name, joint in request.joints.named.items() if joint.profile is not None]
    if profiles:
        reason = f"microrotations at the profile of joint '{profiles[0]}' move the blocks"
        if wanted == "fixed":
            raise CaseError([CaseProblem(("analysis", "kinematics"), f"'fixed' is not allowed: {reason}")])
        return reason
    if wanted != "auto":
        return "" if wanted == "large" else None
    if request.imperfect:
        return "imperfections of blocks leave gaps that may close"
    gaps = gaps_of_start(model)
    gaps = gaps.where(gaps.close)
    if len(gaps.widths):
        return f"{gap_words(model, gaps)} may close"
    wedges = wedges_of_start(model, joint_properties(request, model, ratio=1.0))  # whatever the stiffness
    return f"{gap_words(model, wedges)} may close at one end" if len(wedges.widths) else None


def gaps_may_close(request: SolverRequest, model: Model) -> bool:
    """Test whether blocks start with gaps, drawn or of imperfections, that may close on the way to failure."""
    return request.imperfect or bool(gaps_of_start(model).close.any())


def fixed_beside(request: SolverRequest, model: Model) -> np.ndarray | None:
    """Free blocks of connected structures whose gaps may close, (n_blocks,) bool, where there are others beside them.

    None: nothing moves geometry, or something that is no gap, or every structure has gaps.
    """
    profiled = any(joint.profile is not None for joint in request.joints.named.values())
    if request.analysis.kinematics != "auto" or profiled or request.imperfect or model.links:
        return None
    properties = joint_properties(request, model, ratio=1.0)
    gaps = gaps_of_start(model)
    closing = [gaps.blocks[gaps.close], wedges_of_start(model, properties).blocks]
    if not any(map(len, closing)):
        return None
    joints = joints_of_start(model, bodies_at_rest(model), properties, smallest_edge(model)).joints
    label = structures(np.concatenate([joints.blocks, *closing]), model.fixed)
    moves = np.isin(label, label[np.concatenate(closing)]) & ~model.fixed
    return moves if moves.any() and not moves[~model.fixed].all() else None


def open_gaps_doubt(model: Model) -> str | None:
    """Return the warning about gaps that stay open in fixed geometry; None where there are none."""
    gaps = gaps_of_start(model)
    if not len(gaps.widths):
        return None
    hint = 'with analysis.kinematics = "large" gaps close'
    return f"{gap_words(model, gaps)}: nothing rests there, as the geometry of the start is kept; {hint}"


def live_scale(model: Model) -> float:
    """Factor that makes the live loads as large as the dead ones, so that a multiplier is of the order of one."""
    d, free = model.dimension, ~model.fixed
    dead = np.sqrt((model.dead_loads[free, :d] ** 2).sum(axis=1)).sum()
    live = np.sqrt((model.live_loads[free, :d] ** 2).sum(axis=1)).sum()
    return float(dead / live) if dead > 0.0 and live > 0.0 else 1.0
