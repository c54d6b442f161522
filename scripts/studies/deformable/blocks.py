"""Elastic blocks lumped into their joints: the elastic wall against finite elements, the curve of wall SW100."""

from __future__ import annotations

from typing import Any

import numpy as np

from dem_cli import api
from dem_cli.bench.table import percent
from dem_cli.contact.compatibility import compatibility
from dem_cli.contact.start import bodies_at_rest, joints_of_start
from dem_cli.engine.properties import joint_properties
from dem_cli.model.scales import smallest_edge
from studies.deformable.walls import AT, WALL, curve
from studies.solution import from_file
from studies.template import table

YOUNG, HEIGHT, SHEAR = 15.5e9, 0.1, 0.417  # of the blocks [Pa, m], and ks/kn
BLOCKS = tuple(f"materials.{name}.young={YOUNG!r}" for name in ("sandstone", "concrete"))
# kn h/E: error of rigid blocks against finite elements (Q2, elastic interfaces; scikit-fem, of a prototype)
RIGID = {0.05: -0.047, 0.1: -0.088, 0.44: -0.28, 1.0: -0.47, 3.0: -0.72}


def measure() -> dict[str, Any]:
    """Displacements of the beam [m/N], and both curves."""
    elastic = [
        {"ratio": ratio, "rigid": displacement(ratio), "lumped": displacement(ratio, *BLOCKS)} for ratio in RIGID
    ]
    return {"elastic": elastic, "curves": [curve() | {"blocks": "rigid"}, curve(*BLOCKS) | {"blocks": "lumped"}]}


def displacement(ratio: float, *overrides: str) -> float:
    """Of the beam per newton of its push [m], all joints closed; linear."""
    from scipy.sparse import diags
    from scipy.sparse.linalg import spsolve

    kn = ratio * YOUNG / HEIGHT
    loaded = from_file(WALL, f"joints.dry.kn={kn!r}", f"joints.dry.ks={SHEAR * kn!r}", *overrides)
    model = api.build_model(loaded)
    properties = joint_properties(loaded.case, model)
    joints = joints_of_start(model, bodies_at_rest(model), properties, smallest_edge(model)).joints
    motion = compatibility(model, joints)
    stiffness = diags(np.column_stack([joints.kn, joints.ks]).ravel())
    forces = model.live_loads[~model.fixed].ravel()
    return float(f"{spsolve((motion.T @ stiffness @ motion).tocsc(), forces) @ forces:.6g}")


def values(found: dict[str, Any]) -> dict[str, str]:
    """Tables of the page."""
    rows = []
    for one in found["elastic"]:
        rigid = RIGID[one["ratio"]]
        error = one["lumped"] / one["rigid"] * (1.0 + rigid) - 1.0
        rows.append((f"{one['ratio']:g}", percent(rigid), percent(error), f"{one['lumped'] / one['rigid']:.3f}"))
    curves = [(one["blocks"], f"{one['peak']:.2f}", *(f"{x:.2f}" for x in one["loads"])) for one in found["curves"]]
    return {
        "elastic": table(("kn h/E", "rigid blocks", "lumped", "lumped over rigid"), rows),
        "curves": table(("blocks", "peak", *(f"at {x} mm" for x in AT)), curves),
    }


PICTURES: dict[str, Any] = {}
