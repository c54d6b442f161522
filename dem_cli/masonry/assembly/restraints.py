"""Restraints, [[restraint]]: prevented motions of blocks, such as the rotation of a beam on top of a wall."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.case.wording import either, show
from dem_cli.core.model.model import MOTIONS, NO_RESTRAINTS, Model
from dem_cli.errors import CaseError, CaseProblem

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

ROTATION = "rotation"  # of a block in space: about every axis


def restrained(case: Case, model: Model) -> np.ndarray:
    """Return the motions that restraints prevent, (n_blocks, d + r) bool; empty where there are none.

    Raises CaseError: motions of the other dimension, and rotations about some axes only where blocks have real masses.
    """
    if not case.restraint:
        return NO_RESTRAINTS
    problems, names = list[CaseProblem](), MOTIONS[model.dimension]
    held = np.zeros((model.n_blocks, len(names)), bool)
    for i, table in enumerate(case.restraint):
        blocks = model.chosen(table.selected, False)
        for k, motion in enumerate(table.fixed):
            columns = [name == motion or (motion == ROTATION and name.startswith(ROTATION)) for name in names]
            held[np.ix_(blocks, np.flatnonzero(columns))] = True
            if not any(columns):
                known = either((*names, *(() if ROTATION in names else (ROTATION,))))
                message = f"{show(motion)} is not allowed in {model.dimension}D; must be {known}"
                problems.append(CaseProblem(("restraint", i, "fixed", k), message))
        problems += _partly_turning(case, model, held[blocks], i)
    if problems:
        raise CaseError(problems)
    return held


def _partly_turning(case: Case, model: Model, held: np.ndarray, i: int) -> list[CaseProblem]:
    """Report blocks with real masses in 3D that are restrained about some axes only: their inertia tensor rotates."""
    turns = held[:, model.rotations]
    if not kind_of(case.analysis.kind).real_masses or not (turns.any(axis=1) & ~turns.all(axis=1)).any():
        return []
    message = f"in kind = {show(case.analysis.kind)} a block turns about all axes or about none; give 'rotation'"
    return [CaseProblem(("restraint", i, "fixed"), message)]
