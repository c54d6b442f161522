"""Convert imposed strains of blocks, [[strain]] (warming, swelling, drying), to loads on their deformation modes.

A block that would have the strain ε0 if nothing held it has stresses C : (ε − ε0). That is a load K a0 on its modes, a0
their amplitudes at ε0; of a strain in all directions alike only the first mode has any.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.case.wording import show
from dem_cli.core.model.model import Model
from dem_cli.errors import CaseProblem

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


def with_imposed_strains(case: Case, model: Model) -> Model:
    """Add the imposed strains of all [[strain]] tables, and their generalised forces, to the model."""
    total = np.zeros(model.n_blocks)
    for table in case.strain:
        total[model.chosen(table.selected, fixed=False)] += table.value
    loads = model.dead_mode_loads.copy()
    loads[:, 0] += model.mode_stiffness[:, 0] * total * model.shapes.radii
    return model._replace(imposed_strains=np.where(model.fixed, 0.0, total), dead_mode_loads=loads)


def problems(case: Case, model: Model) -> Iterator[CaseProblem]:
    """Report imposed strains of rigid blocks, and where dead loads turn."""
    tables = list(case.materials.values())
    strains = np.array([table.strains for table in tables])[model.block_material] & ~model.fixed
    for i, table in enumerate(case.strain):
        chosen = model.chosen(table.selected, fixed=False)
        rigid = chosen[~strains[chosen]]
        key = "block" if table.block is not None else "structure"
        if len(rigid):
            name, what = model.block_ids[rigid[0]], "is fixed" if model.fixed[rigid[0]] else "has no strain of its own"
            need = "only blocks of deformation = 'uniform-strain' or 'quadratic' that can move swell or shrink"
            yield CaseProblem(("strain", i, key), f"block {show(name)} {what}; {need}")
    if case.strain and getattr(case.analysis, "pattern", None) == "tilt":
        yield CaseProblem(("analysis", "pattern"), "'tilt' is not known with [[strain]], which does not turn")
