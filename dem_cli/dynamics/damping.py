"""[damping] of time histories: what joints and blocks lose, beside friction."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dem_cli.contact.joints import JointArrays
from dem_cli.dynamics.restitution import fraction_of, reference_block
from dem_cli.engine.settings import DEFAULT, Settings
from dem_cli.engine.viscous import Damping, element_numbers
from dem_cli.model.model import Model
from dem_cli.tables.damping import DEFAULT_FRACTION, DampingTable

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


def damping_of(case: Case, model: Model, start: JointArrays, settings: Settings = DEFAULT) -> Damping:
    """The [damping] of a case in numbers. Raises CaseError for an unknown block or a restitution out of reach.

    start: joints of the undeformed structure.
    """
    table: DampingTable = case.damping or DampingTable(contact_fraction=DEFAULT_FRACTION)
    mass, stiffness, fraction, words = table.mass or 0.0, table.stiffness or 0.0, 0.0, []
    if table.rayleigh is not None:
        more, stiffness = table.rayleigh.coefficients()
        mass += more
        words.append(f"Rayleigh, {table.rayleigh.ratio:.3g} of critical")
    if table.stiffness:
        words.append("dashpots of the joints")
    if table.restitution is not None:
        fraction, said = fraction_of(case, model, start, table, settings)
        words.append(said)
    if table.contact_fraction:
        fraction = table.contact_fraction
        words.append(f"dashpots of the joints, {fraction:.3g} of critical")
    if fraction and table.block is not None:
        stiffness, fraction = 2.0 * fraction / reference_block(model, start, table).frequency, 0.0
        words[-1] += f" at the frequency of block '{table.block}'"
    if table.mass:
        words.append("mass-proportional")
    if table.maxwell:
        words.append(f"{len(table.maxwell)} Maxwell elements")
    if table.local:
        words.append(f"local, {table.local:.3g}")
    elements = element_numbers(table.maxwell or ())
    return Damping(fraction, stiffness, mass, table.local or 0.0, elements, ", ".join(words) or "none")
