"""Damping of time histories ([damping]): energy that joints and blocks lose beside friction."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dem_cli.core.contact.joints import JointArrays
from dem_cli.core.dynamics.restitution import fraction_of, reference_block
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.viscous import Damping, element_numbers
from dem_cli.core.model.model import Model

if TYPE_CHECKING:
    from dem_cli.core.records.requests import SolverRequest


def damping_of(request: SolverRequest, model: Model, start: JointArrays, settings: Settings = DEFAULT) -> Damping:
    """Convert the requested damping into coefficients of the solver. Raises CaseError for an unknown block or a
    restitution out of reach.

    start: joints of the undeformed structure.
    """
    asked = request.damping
    mass, stiffness, fraction, words = asked.mass, asked.stiffness, 0.0, []
    if asked.rayleigh is not None:
        stiffness = asked.rayleigh.stiffness
        mass += asked.rayleigh.mass
        words.append(f"Rayleigh, {asked.rayleigh.ratio:.3g} of critical")
    if asked.stiffness:
        words.append("dashpots of the joints")
    if asked.restitution is not None:
        fraction, said = fraction_of(request, model, start, settings)
        words.append(said)
    if asked.contact_fraction:
        fraction = asked.contact_fraction
        words.append(f"dashpots of the joints, {fraction:.3g} of critical")
    if fraction and asked.block is not None:
        stiffness, fraction = 2.0 * fraction / reference_block(model, start, asked).frequency, 0.0
        words[-1] += f" at the frequency of block '{asked.block}'"
    if asked.mass:
        words.append("mass-proportional")
    if asked.maxwell:
        words.append(f"{len(asked.maxwell)} Maxwell elements")
    if asked.local:
        words.append(f"local, {asked.local:.3g}")
    elements = element_numbers(asked.maxwell)
    return Damping(fraction, stiffness, mass, asked.local, elements, ", ".join(words) or "none")
