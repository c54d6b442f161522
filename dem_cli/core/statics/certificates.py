"""Certificates of a failure load: contact forces that stand, a mechanism that bounds it, a motion that fails.

They are for those who do not trust this program: tests/oracle/check_certificate.py checks them from the corners of the
blocks alone. Nothing is solved here; what a search knows already is collected.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.contact.joints import points_in_use
from dem_cli.core.engine import measures
from dem_cli.core.geometry.rotation import quaternions
from dem_cli.core.kernels import records as slot
from dem_cli.core.records.certificate_record import (
    NO_CERTIFICATE,
    BoundMechanism,
    Certificates,
    FailingMotion,
    StandingForces,
)
from dem_cli.core.statics.agreement import unique
from dem_cli.errors import UsageError

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.engine.state import SavedState
    from dem_cli.core.limit.analysis import LimitLoads
    from dem_cli.core.statics.failure_bracket import FailureLoad

STANDS, IMPOSSIBLE, FAILS, UNIQUE = "stands", "impossible", "fails", "unique"


def certificates(sim: Simulation, search: FailureLoad, start: LimitLoads | None) -> Certificates:
    """Collect the certificates of the claims of a search.

    sim: that of the search; it is left as it was. start: limit analysis of the drawn geometry, where the search has
    none of its own; None: there is none.
    """
    why = _why_none(sim)
    if why is not None:
        return Certificates(dict.fromkeys((STANDS, IMPOSSIBLE, FAILS, UNIQUE), NO_CERTIFICATE + why))
    end = sim.save()
    try:
        standing, stands = _standing(sim, search)
        failing, fails = _failing(sim, search)
    finally:
        sim.restore(end)
    own = search.limits.loads() if search.limits is not None else None
    mechanism, impossible = _mechanism(own or start, sim.origin if own is not None else np.zeros_like(sim.origin))
    words = {STANDS: stands, IMPOSSIBLE: impossible, FAILS: fails, UNIQUE: _unique(search, mechanism)}
    return Certificates(words, standing, mechanism, failing)


def _why_none(sim: Simulation) -> str | None:
    """Return why no claim about a structure has a certificate; None: that is not so."""
    if sim.model.links:
        return "ties and bars carry forces that no certificate holds"
    if sim.model.n_modes:
        return "blocks deform, and certificates are of rigid ones"
    if sim.following is not None:
        return "loads follow their blocks"
    if sim.properties.rough:
        return "joints have a profile"
    from dem_cli.core.limit.cone import friction_of

    try:
        friction_of(sim.joints, sim.law)
    except UsageError:
        return f"joints of law '{sim.law.name}' have more than constant friction"
    return None


def _standing(sim: Simulation, search: FailureLoad) -> tuple[StandingForces | None, str]:
    """Collect the contact forces of the highest load held at rest; returns them, and what they certify."""
    if search.held is None or search.low is None:
        return None, f"{NO_CERTIFICATE}no load was held at rest"
    from dem_cli.core.limit.cone import friction_of

    sim.restore(search.held)
    record, used = measures.contact_record(sim), points_in_use(sim.joints)
    acts = record.normal_force != 0.0
    points = record.points if sim.kinematics == "large" else (sim.joints.points + sim.origin)[used]
    friction = friction_of(sim.joints, sim.law)[used]
    columns = (points, record.normals, record.tangents, record.normal_force, record.shear_force, friction)
    table = np.column_stack([values[acts] for values in columns if values.shape[1:] != (0,)])
    found = StandingForces(_factors(sim), _places(sim), record.blocks[acts], table)
    return found, f"stands at a load multiplier of {float(search.low)!r}"


def _factors(sim: Simulation) -> np.ndarray:
    """Return what dead and live loads of the model are multiplied by now, (2,)."""
    return np.array([sim.control[slot.DEAD_FACTOR], sim.control[slot.LIVE_FACTOR] * sim.live_scale])


def _places(sim: Simulation) -> np.ndarray:
    """Return centroids and orientations of the geometry in which forces act now, (n_blocks, 3 or 7)."""
    if sim.kinematics == "large":
        return np.column_stack([sim.bodies.positions + sim.origin, quaternions(sim.bodies.orientations)])
    unturned = quaternions(np.zeros_like(sim.bodies.orientations))
    return np.column_stack([sim.model.centroids, unturned])


def _mechanism(limits: LimitLoads | None, origin: np.ndarray) -> tuple[BoundMechanism | None, str]:
    """Collect the mechanism of limit analysis with its forces; returns them, and what they certify.

    origin: of the coordinates of its contact points [m], (d,).
    """
    upper = None if limits is None else limits.associated.upper
    if limits is None or upper is None:
        why = "limit analysis was not done" if limits is None else f"limit analysis says: {limits.associated.status}"
        return None, NO_CERTIFICATE + why
    found, structure, d = limits.associated, limits.structure, limits.structure.model.dimension
    joints, n = structure.joints, len(found.normal)
    axes = joints.frames[:n, : d if d == 2 else 2 * d]  # normal, in space with the first tangent
    table = np.column_stack([joints.points[:n] + origin, axes, found.normal, found.shear, limits.friction[:n]])
    bounds = np.array([found.multiplier, upper], float)
    certified = BoundMechanism(bounds, found.velocities, joints.blocks[joints.owners[:n]], table)
    return certified, f"impossible above a load multiplier of {float(upper)!r} in the geometry as drawn"


def _failing(sim: Simulation, search: FailureLoad) -> tuple[FailingMotion | None, str]:
    """Collect places and energies at both ends of the motion that shows a failure; returns them, and what they
    certify."""
    before, failing, verdict = search.failed_from or search.held, search.failed_state, search.failing
    if search.high is None or verdict is None:
        return None, f"{NO_CERTIFICATE}no motion shows a failure"
    fails = f"fails at a load multiplier of {float(search.high)!r}"
    if search.impossible:  # its motion may have been begun by a little more load: it is no proof of its own
        return None, f"{fails} because the mechanism makes it impossible"
    if before is None or failing is None:
        return None, f"{NO_CERTIFICATE}no motion shows a failure"
    if verdict.block is not None:
        return None, f"{NO_CERTIFICATE}block '{verdict.block}' came to rest elsewhere"
    if verdict.buckles:
        return None, f"{NO_CERTIFICATE}an equilibrium buckles, which its tangent stiffness shows"
    places, energies = zip(*(_instant(sim, state) for state in (before, failing)), strict=True)
    found = FailingMotion(_factors(sim), np.stack(places), np.array(energies))
    return found, fails


def _instant(sim: Simulation, state: SavedState) -> tuple[np.ndarray, list[float]]:
    """Return the places of the blocks in a state, and work of the loads, friction, elastic and kinetic energy [J]."""
    sim.restore(state)
    orientations = quaternions(sim.bodies.orientations)
    places = np.column_stack([sim.bodies.positions + sim.origin, orientations])
    external, friction = float(sim.ledger[slot.EXTERNAL]), float(sim.ledger[slot.FRICTION])
    return places, [external, friction, sim.elastic_energy(), sim.kinetic_energy()]


def _unique(search: FailureLoad, mechanism: BoundMechanism | None) -> str:
    """Return what is certified about other loads: that no mechanism of the bound slides."""
    if not unique(search):
        return f"{NO_CERTIFICATE}the answer does not claim it"
    if mechanism is None:
        return f"{NO_CERTIFICATE}there is no mechanism"
    return "no mechanism at the bound slides, and the bracket holds the bound"
