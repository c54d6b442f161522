"""Limit analysis of a model: from its geometry at the start to failure loads."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.contact.gaps import gap_words, gaps_of_start
from dem_cli.contact.joints import JointProperties, only_points
from dem_cli.contact.start import bodies_at_rest, joints_of_start
from dem_cli.laws.law import Law
from dem_cli.limit.associated import FALLS, LOCKED, OK, LimitLoad, limit_load
from dem_cli.limit.cone import friction_of
from dem_cli.limit.matrices import Structure, structure_of
from dem_cli.limit.settings import DEFAULT_LIMIT, LimitSettings
from dem_cli.model.model import Model
from dem_cli.model.scales import smallest_edge

if TYPE_CHECKING:
    from dem_cli.limit.path import Path

Progress = Callable[[float, float], None]


class LimitLoads(NamedTuple):
    """Failure loads of one structure by limit analysis."""

    structure: Structure
    friction: np.ndarray  # coefficient of every point [-], (n_points,)
    associated: LimitLoad  # joints dilate as they slide: an upper bound
    non_associated: Path | None  # joints do not; None where not asked for, or where the first answer leaves no question
    seconds: float  # wall time of the associated load, with detection and matrices
    path_seconds: float | None  # of the non-associated load

    def summary(self) -> dict[str, Any]:
        """What summary.json says under `limit_analysis`."""
        found, ok = self.associated, self.associated.status == OK
        said = {
            "associated": found.multiplier if ok else None,
            "associated_bounds": [found.lower, found.upper] if ok else None,
            "associated_status": found.status,
            "residual": found.residual,
            "gap": found.gap,
            "iterations": found.iterations,
            "seconds": self.seconds,
        }
        path = self.non_associated
        if path is None:
            return said
        of_path = path.summary()
        load = of_path.pop("load")
        said["non_associated"] = load if path.status == OK else None
        if path.status != OK and load is not None:
            said["non_associated_at_least"] = load  # every state of the path is in equilibrium
        said |= {f"non_associated_{key}": value for key, value in of_path.items()}
        return said | {"non_associated_seconds": self.path_seconds}


def limit_loads(
    model: Model,
    properties: JointProperties,
    law: Law,
    heads_frictionless: bool = False,
    associated_only: bool = False,
    progress: Progress = lambda load, reached: None,
    settings: LimitSettings = DEFAULT_LIMIT,
) -> LimitLoads:
    """Limit analysis of the faces that touch at the start; the multiplier is that of model.live_loads.

    heads_frictionless  no friction in joints steeper than 45° to the horizontal (thesis Table 5-3)
    associated_only     leave out the load of joints that do not dilate, which takes longer
    progress            told the load and the displacement of every increment of the latter (limit.path)

    Raises UsageError without live loads, or where the law has no cone |T| ≤ μ N.
    """
    begun = time.perf_counter()
    structure = start_structure(model, properties)
    friction = friction_of(structure.joints, law, heads_frictionless)
    associated = limit_load(structure, friction, settings.associated)
    seconds = time.perf_counter() - begun
    if associated_only or associated.status in (FALLS, LOCKED) or not structure.dead.any():
        return LimitLoads(structure, friction, associated, None, seconds, None)
    from dem_cli.limit.path import trace  # with SciPy's solvers

    path = trace(structure, friction, progress=progress, settings=settings)
    return LimitLoads(structure, friction, associated, path, seconds, time.perf_counter() - begun - seconds)


def taken_as_plane(properties: JointProperties) -> str | None:
    """What is to be said of joints with a profile, which limit analysis does not see; None: there are none."""
    rough = [
        f"'{name}'"
        for name, layout in zip(properties.names, properties.layouts, strict=True)
        if layout is not None and layout.sides is not None
    ]
    return f"limit analysis takes joint {', '.join(rough)} as plane: it knows no profile" if rough else None


def gaps_left_open(model: Model) -> str | None:
    """What is to be said of gaps of the start, which rigid blocks at rest do not close; None: there are none."""
    gaps = gaps_of_start(model)
    return f"limit analysis closes no gaps: {gap_words(model, gaps)}" if len(gaps.widths) else None


def start_structure(model: Model, properties: JointProperties) -> Structure:
    """The structure with the joints of its first place, all of them plane: points at their ends are enough.

    Points that are open carry nothing: where only a corner touches a face, the other end is far from anything.
    """
    properties = properties._replace(layouts=(None,) * len(properties.layouts))
    built = joints_of_start(model, bodies_at_rest(model), properties, smallest_edge(model))
    return structure_of(model, only_points(built.joints, built.contacts.gaps <= 0.0))
