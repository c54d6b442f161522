"""From the [joints] of a case to numbers for every pair of materials."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.contact.assemble import JointProperties
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.laws.law import Law
from dem_cli.laws.registry import LAWS
from dem_cli.model.assemble import joint_table
from dem_cli.model.model import Model
from dem_cli.model.scales import stiffness_scale

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

FIXED_RATIO = 1e6  # kn·h/W of "auto" joints where the stiffness drops out


def law_of(case: Case) -> Law:
    """The one law of all joints. Raises CaseError where the case mixes laws."""
    laws = {table.law for table in case.joints.values()}
    if len(laws) > 1:
        name = list(case.joints)[1]
        raise CaseError([CaseProblem(("joints", name, "law"), "different laws in one case are not available yet")])
    return LAWS[laws.pop()]


def joint_properties(case: Case, model: Model, ratio: float = FIXED_RATIO) -> JointProperties:
    """Stiffness and law parameters of each named joint; "auto" means kn·h/W = ratio, and ks = kn."""
    names, by_material = joint_table(case)
    auto = ratio * stiffness_scale(model)
    law = law_of(case)
    kn = np.array([auto if case.joints[n].kn == "auto" else case.joints[n].kn for n in names])
    ks = np.array([k if case.joints[n].ks == "auto" else case.joints[n].ks for n, k in zip(names, kn, strict=True)])
    columns = np.array([law.columns(case.joints[name]) for name in names], float)
    return JointProperties(names, by_material, kn, ks, columns)
