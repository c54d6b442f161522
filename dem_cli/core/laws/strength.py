"""Strength reduction of joints: tan φ / F, c / F, ft / F.

Keys of the same name mean the same strength in every law; residual strengths are reduced with the others. What a law
asks of its strengths among each other goes on to hold: the tensile strength ends at the tip of the cone, and no joint
dilates more than it rubs. Fracture energies and compressive strength stay.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

from dem_cli.core.laws.friction import FrictionJoint
from dem_cli.core.laws.stiffness import StiffJoint

KEYS = {  # strength -> keys of [joints.*] that hold it
    "friction": ("friction", "friction_residual", "friction_dynamic"),
    "cohesion": ("cohesion", "cohesion_residual"),
    "tension": ("tension", "tension_residual"),
}


def strengths(joint: StiffJoint) -> dict[str, float]:
    """List friction coefficient [-], cohesion and tensile strength [Pa] of a joint, as far as its law has them."""
    found = {"friction": joint.coefficient} if isinstance(joint, FrictionJoint) else {}
    return found | {name: float(getattr(joint, name)) for name in ("cohesion", "tension") if hasattr(joint, name)}


def reduced(joint: StiffJoint, factor: float, which: Collection[str]) -> StiffJoint:
    """Divide the strengths `which` (of KEYS) of a joint by `factor`; a factor below 1 makes it stronger.

    Raises ValueError, as `Parameters` do, where the result is beyond what the law allows.
    """
    data = {name: getattr(joint, name) for name in joint.names_given}
    if isinstance(joint, FrictionJoint) and "friction" in which:
        data.pop("friction_angle_deg", None)
        data["friction"] = joint.coefficient
    for key in (key for name in which for key in KEYS[name] if data.get(key) is not None):
        data[key] = data[key] / factor
    _keep_within(data, joint)
    return type(joint)(**data)


def _keep_within(data: dict[str, Any], joint: StiffJoint) -> None:
    """Limit tensile strength to the tip of the cone, residual to peak strength, dilation to friction; in place."""
    if not isinstance(joint, FrictionJoint):
        return
    friction = data["friction"] if data.get("friction") is not None else joint.coefficient
    residual = data.get("friction_residual")
    residual = friction if residual is None else residual
    for suffix, slope in (("", friction), ("_residual", residual)):
        key = f"tension{suffix}"
        if data.get(key) is None:
            continue
        if slope > 0.0:
            data[key] = min(data[key], data.get(f"cohesion{suffix}", 0.0) / slope)
        data[key] = min(data[key], data["tension"])
    if data.get("dilation_deg"):
        data["dilation_deg"] = min(data["dilation_deg"], math.degrees(math.atan(residual)))
