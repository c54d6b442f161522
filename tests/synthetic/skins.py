"""Outside of a structure: area of all faces less, twice, that of the joints; what is left is in the open."""

from __future__ import annotations

from typing import Any

from dem_cli.assembly.assemble import assembly
from dem_cli.assembly.validate import problems
from dem_cli.contact.between import StartJoints
from dem_cli.model.model import Model
from synthetic.spatial_case import spatial_case


def model_of(*structures: dict[str, Any], **tables: Any) -> Model:
    """The model of structures in 3D, without a problem of their geometry."""
    case = spatial_case(structure=list(structures), **tables)
    made = assembly(case)
    found = [str(problem.message) for problem in problems(case, made.model, made.blocks)]
    assert [message for message in found if "no block is fixed" not in message] == []
    return made.model


def open_area(model: Model) -> float:
    """Area of all faces that no other block touches [m²]; faces within a compound are none."""
    own = float(model.faces.areas[~model.inner_faces].sum())
    return own - 2.0 * float(StartJoints(model).faces.areas.sum())


def free_volume(model: Model) -> float:
    """Volume of all blocks that can move [m³]."""
    return float(model.shapes.volumes[~model.fixed].sum())
