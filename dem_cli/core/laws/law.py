"""Interface of a joint law.

A law is one plain scalar function, compiled into the contact loop:

    law(gap, slide, shear, kn, ks, parameters, joint, memory, point) -> (normal, shear, slipped)

gap         opening of the point [m], positive open
slide       tangential displacement of b against a in this step [m], d − 1 components
shear       shear force on b before the step [N], d − 1 components
kn, ks      stiffness of the point [N/m]
parameters  the law's numbers, parameters[joint, :]; stresses become forces by the area of the point, kn over the
            kn of the joint [Pa/m], which a law that needs it keeps as a column
memory      what the law remembers, memory[point, :]: its scalars, then its vectors along the tangents
normal      normal force [N], compression positive
slipped     True where something was lost: the shear spring was cut back, a bond gave way, stone was crushed

A new law: one file with such a function and a `Law` record, one line in the registry.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from dem_cli.core.laws.envelope import Envelope
from dem_cli.declarations import Parameters

JointTable = TypeVar("JointTable", bound=Parameters)


@dataclass(frozen=True)
class Law(Generic[JointTable]):
    """Joint law as it is registered, with the table of its parameters."""

    name: str  # `law` in the case file
    parameters: type[JointTable]  # the [joints.*] table
    function: Callable  # the scalar law, see the module docstring
    columns: Callable[[JointTable, float], tuple[float, ...]]  # (table, kn [Pa/m]) -> row of `parameters`
    # (parameters, normal forces, memory, kn of the points) -> largest shear forces, all (n_points, ...)
    shear_limit: Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]
    # For limit analysis, (parameters, kn) of the points -> what they carry at most (laws/envelope.py); None: that has
    # no straight lines. `residual`: what is left when a point has slid and opened for long; None: all of it.
    envelope: Callable[[np.ndarray, np.ndarray], Envelope] | None = None
    residual: Callable[[np.ndarray, np.ndarray], Envelope] | None = None
    # Of points in space that come to be while blocks are in each other: (parameters, overlaps [m], negative: open,
    # memory, kn of the points) -> normal forces [N], as `function` finds them at rest: a law that deforms for good
    # across the joint takes off what is no spring, one that dilates or is bonded adds what it holds by that.
    pressed: Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray] = (
        lambda parameters, overlaps, memory, kn: kn * np.maximum(overlaps, 0.0)
    )
    # The same law without branches, for LANES points at once (kernels/tiles): numbers[at + k·LANES] for
    # parameters[joint, k], no memory; `slipped` is left out where no force was there before nor is now. None: there is
    # no such form.
    of_lanes: Callable | None = None
    n_of_lanes: int = 0  # so many first numbers of `parameters`
    scalars: int = 0  # numbers that a point remembers
    vectors: int = 0  # vectors along the tangents that it remembers beside them
    intact: tuple[float, ...] = ()  # first scalars of points that touch at the start; all others start from zero
    # Carries tension, or deforms for good across the joint: called for open points too, and the work that its
    # normal springs lose is counted in the energy balance as well.
    bonded: bool = False
    rates: tuple[int, ...] = ()  # columns that are velocities [m/s]: handed to the law as displacement per step
    variant: Callable[[JointTable], Law | None] = lambda table: None  # another law that this table asks for
    source: str = ""  # where the law is published

    def n_memory(self, dimension: int) -> int:
        """Number of columns of `memory` of a contact point."""
        return self.scalars + self.vectors * (dimension - 1)

    def of(self, table: JointTable) -> Law:
        """Return the law itself, or the variant of it that this table selects."""
        return self.variant(table) or self
