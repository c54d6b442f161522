"""The contract of a joint law.

A law is one plain scalar function, compiled into the contact loop:

    law(gap, slide, shear, kn, ks, parameters, joint, memory, point) -> (normal, shear, slipped)

gap         opening of the point [m], positive open
slide       tangential displacement of b against a in this step [m], d − 1 components
shear       shear force on b before the step [N], d − 1 components
kn, ks      stiffness of the point [N/m]
parameters  the law's numbers, parameters[joint, :]
memory      what the law remembers, memory[point, :]
normal      normal force [N], compression positive
slipped     True where the shear spring was cut back (its work goes to friction)

A new law: one file with such a function and a `Law` record, one line in the registry.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dem_cli.case.base import CaseModel


@dataclass(frozen=True)
class Law:
    """A registered joint law."""

    name: str  # `law` in the case file
    parameters: type[CaseModel]  # the [joints.*] table
    function: Callable  # the scalar law, see the module docstring
    columns: Callable[[CaseModel], tuple[float, ...]]  # table -> row of `parameters`
    shear_limit: Callable[[np.ndarray, np.ndarray], np.ndarray]  # (parameters, normal forces) -> largest shear forces
    n_memory: int = 0  # columns of `memory`
    source: str = ""  # where the law is published
