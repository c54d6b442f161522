"""Compressive strength (cap) of bonded joints: beyond fc the point is crushed, perfectly plastic, whatever its bond
does.

    N ≤ fc A,   the bond sees the gap + z

z is the closing that has gone into crushing; it stays, so that the point unloads with kn and opens at gap = −z. Crushed
stone that opens has no bond left: from then on it is a crack that meets again. Cohesion stays while it is pressed.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dem_cli.core.kernels.jit import inline, named
from dem_cli.core.laws.envelope import Envelope
from dem_cli.core.laws.law import Law
from dem_cli.declarations import KeyProblem


def capped(law: Law, name: str, column: int) -> Law:
    """Add a compressive strength to a law of bonded points; column: of `parameters` in which fc [Pa] stands, behind
    those of the law.

    The law has kn [Pa/m] as its first number, remembers in its first scalar that it was never bonded as 0, and opens
    at no other gap than zero. Source: the cap of Lourenço and Rots 1997, without hardening and cut off straight.
    """
    depth = law.scalars  # where the point remembers z [m]

    def most(parameters: np.ndarray, kn: np.ndarray) -> np.ndarray:
        """Compute the compressive strength fc A [N]."""
        return parameters[:, column] * kn / parameters[:, 0]

    def with_cap(find: Callable) -> Callable:
        def found(parameters: np.ndarray, kn: np.ndarray) -> Envelope:
            whole: Envelope = find(parameters, kn)
            return whole._replace(compression=most(parameters, kn))

        return found

    def pressed(parameters, overlaps, memory, kn):
        """Compute normal forces of capped points [N]: of the bond, at most fc A; crushed stone is not pulled."""
        crushed = memory[:, depth]
        normal = np.minimum(law.pressed(parameters, overlaps - crushed, memory, kn), most(parameters, kn))
        return np.where(crushed > 0.0, np.maximum(normal, 0.0), normal)

    assert law.envelope is not None
    return Law(
        name=name,
        parameters=law.parameters,
        function=_with_cap(law.function, depth, column),
        columns=lambda table, kn: (*law.columns(table, kn), table.compression),
        shear_limit=law.shear_limit,
        envelope=with_cap(law.envelope),
        residual=with_cap(law.residual or law.envelope),
        pressed=pressed,
        scalars=law.scalars + 1,
        vectors=law.vectors,
        intact=law.intact,
        bonded=True,
        source=law.source,
    )


def check_cap(compression: float | None, tension: float) -> None:
    """Check that the compressive strength exceeds the tensile one, both in Pa; raises KeyProblem."""
    if compression is not None and compression <= tension:
        raise KeyProblem(f"{compression:g} Pa; must be more than tension = {tension:g} Pa", "compression")


def _with_cap(bond: Callable, depth: int, column: int) -> Callable:
    """Wrap the scalar law `bond` with a compressive strength."""

    @inline
    def crushed_bond(gap, slide, shear, kn, ks, parameters, joint, memory, point):
        """Compute the forces of a bonded point that can be crushed; remembers the crushed depth."""
        crushed, most, crushes = memory[point, depth], parameters[joint, column] / parameters[joint, 0], False
        opening = gap + crushed
        if opening < -most:
            memory[point, depth] = -gap - most
            opening, crushes = -most, True
        elif crushed > 0.0 and opening >= 0.0:
            memory[point, 0] = 0.0
        normal, sheared, slipped = bond(opening, slide, shear, kn, ks, parameters, joint, memory, point)
        return normal, sheared, slipped or crushes

    return named(crushed_bond, f"{depth} {column}", bond)
