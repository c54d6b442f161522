"""A solid under water, all of its faces wet."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dem_cli.app.api import make_case_model
from dem_cli.case.reader import CaseSource, validate
from dem_cli.masonry.assembly.assemble import assembly


def floating(corners: np.ndarray, level: float):
    """The load of water on a solid with these corners (n, 3), its volume and its centroid."""
    floor = {"id": "floor", "polygon": [[-9, -9], [9, -9], [9, -8], [-9, -8]], "y": [-9, 9], "fixed": True}
    tables = {
        "dimension": 3,
        "materials": {"stone": {"density": 1.0}},
        "joints": {"dry": {"friction": 0.6}},
        "block": [{"id": "solid", "vertices": corners.tolist()}, floor],
        "pressure": [{"block": "solid", "face": "all", "fluid": {"level": level}}],
    }
    made = assembly(validate(tables, make_case_model(), CaseSource(Path("case.toml"), "")))
    solid = made.model.numbers["solid"]
    return made.loads[0], float(made.model.masses[solid]), made.model.centroids[solid]
