"""Kinematics of a run: whether its geometry moves on the way to failure, and the scale of its live loads."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.contact.detect import find_joints
from dem_cli.contact.start import TOUCHING_GAP
from dem_cli.engine.settings import DEFAULT, Settings
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.model.model import Model
from dem_cli.model.places import undeformed
from dem_cli.model.scales import smallest_edge

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


def why_moving(case: Case, model: Model, settings: Settings = DEFAULT) -> str | None:
    """Why geometry moves on the way to failure ("": the case says so); None: that of the start is good enough.

    Raises CaseError where the case asks for fixed geometry that its joints do not allow.
    """
    wanted = case.analysis.kinematics
    profiles = [name for name, joint in case.joints.items() if joint.profile is not None]
    if profiles:
        reason = f"microrotations at the profile of joint '{profiles[0]}' move the blocks"
        if wanted == "fixed":
            raise CaseError([CaseProblem(("analysis", "kinematics"), f"'fixed' is not allowed: {reason}")])
        return reason
    if wanted != "auto":
        return "" if wanted == "large" else None
    if case.imperfection:
        return "imperfections of blocks leave gaps that may close"
    gaps = open_joints(model, settings.detection.meant_gap)
    return f"{gaps} joints have gaps that may close" if gaps else None


def live_scale(model: Model) -> float:
    """Factor that makes the live loads as large as the dead ones, so that a multiplier is of the order of one."""
    d, free = model.dimension, ~model.fixed
    dead = np.sqrt((model.dead_loads[free, :d] ** 2).sum(axis=1)).sum()
    live = np.sqrt((model.live_loads[free, :d] ** 2).sum(axis=1)).sum()
    return float(dead / live) if dead > 0.0 and live > 0.0 else 1.0


def open_joints(model: Model, meant_gap: float = DEFAULT.detection.meant_gap) -> int:
    """How many faces start so close that they may meet: the geometry of the start is wrong for them."""
    edge = smallest_edge(model)
    return int((np.abs(find_joints(model, undeformed(model), meant_gap * edge).separation) > TOUCHING_GAP * edge).sum())
