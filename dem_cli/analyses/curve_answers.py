"""Results of a capacity curve: peak, residual, loads at displacements, bilinear system, check against a spectrum."""

from __future__ import annotations

from typing import Any

import numpy as np

from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.case.tables.code_check import CodeCheck
from dem_cli.core.arithmetic.products import product
from dem_cli.core.code_checks import local_mechanism, n2
from dem_cli.core.code_checks.oscillator import participation
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.engine.state import SavedState
from dem_cli.core.motion.eurocode import SOILS
from dem_cli.core.statics.bilinear import bilinear, load_at
from dem_cli.core.statics.displacement_control import CapacityCurve

LEAST_FORCE = 1e-3  # of all weights, from which dead loads without mass are worth a word
CORNER = 2  # of a row of core/motion/eurocode.py: SOILS


def summary(job: CaseJob, curve: CapacityCurve, force: float, scale: float) -> dict[str, Any]:
    """Return the summary of the capacity curve; load multipliers of the case, displacements in m.

    force: sum of the forces of the live load at an internal multiplier of one [N]; scale: multiplier of users at that.
    """
    analysis = job.case.analysis
    displacements, loads = curve.arrays()
    loads = loads * scale
    peak, last = curve.highest, curve.points[-1]
    wanted, out = analysis.idealise, slice(curve.farthest + 1)
    system = bilinear(displacements[out], loads[out], wanted.secant, wanted.drop)
    at = load_at(displacements, loads, np.array(analysis.loads_at))
    return {
        "displacements": displacements.tolist(),
        "loads": loads.tolist(),
        "force_at_load_1": force / scale,
        "peak_load": peak.load * scale,
        "peak_displacement": peak.displacement,
        "last_load": last.load * scale,
        "last_displacement": last.displacement,
        "residual_share": last.load / peak.load if peak.load > 0.0 else None,
        "whole": curve.whole,
        "loads_at": [{"displacement": u, "load": load} for u, load in zip(analysis.loads_at, at.tolist(), strict=True)],
        "bilinear": system
        and system._asdict() | {"secant": wanted.secant, "drop": wanted.drop, "automatic_joints": automatic(job)},
    }


def automatic(job: CaseJob) -> bool:
    """Test whether some joint has kn = "auto", so that elastic displacements and periods are not physical."""
    return any(joint.kn == "auto" for joint in job.case.joints.values())


def shaken_masses(sim: Simulation, gravity: float) -> np.ndarray:
    """Return the masses of the free blocks, with dead loads that have inertia, by their share of the live load [kg].

    For pattern = "mass" alone, where the live load is the weight of all masses along a direction.
    """
    masses, live = sim.model.masses[sim.free], sim.model.live_loads[sim.free, : sim.model.dimension]
    along = live.sum(axis=0)
    if not along.any() or gravity == 0.0:
        return masses
    more = product(live, along / np.sqrt((along**2).sum())) / gravity - masses
    return masses + more if more.max() > 1e-9 * masses.max() else masses


class CurveCheck:
    """Check of a capacity curve against a response spectrum, with the warnings about it."""

    def __init__(self, job: CaseJob, sim: Simulation, table: CodeCheck) -> None:
        self.job, self.sim, self.table = job, sim, table
        self.masses = shaken_masses(sim, job.case.gravity)

    def run(self, found: dict[str, Any], curve: CapacityCurve, states: tuple[SavedState, SavedState]) -> dict[str, Any]:
        """Return the key `check` of the summary; empty, with a warning, where there is no result.

        found: what the summary says of the curve. states: at rest under dead loads, and at the end of the curve.
        """
        table, spectrum = self.table, self.table.target
        name = table.shape or ("end" if table.method == "mechanism" else "peak")
        before, end = states
        after = {"first": curve.at_first, "peak": curve.at_peak, "end": end}.get(name)
        least = self.sim.settings.mechanism.takes_part if table.method == "mechanism" else 0.0
        try:
            parts = participation(self.masses, self._shape(before, after), least)
        except ValueError as error:
            return self._nothing(str(error))
        self._without_mass()
        gravity = found["force_at_load_1"] / float(self.masses.sum())
        answer: dict[str, Any] | None
        if table.method == "n2":
            if automatic(self.job):
                return self._nothing("with kn = 'auto' the period is that of the solver's joints; give kn and ks")
            if not found["bilinear"]:
                return self._nothing("the curve carries nothing")
            answer = n2.check(found["bilinear"], parts, gravity, spectrum, self._corner())
        else:
            displacements, loads = np.array(found["displacements"]), np.array(found["loads"])
            confidence, behaviour = table.confidence or 1.0, table.behaviour or 2.0
            answer = local_mechanism.check((displacements, loads), parts, gravity, spectrum, confidence, behaviour)
            if answer is None:
                end_of = f"its end, {100 * found['residual_share']:.3g} % of its peak"
                return self._nothing(f"where the curve is zero cannot be told from {end_of}; more of analysis.follow")
        told = {"method": table.method, "spectrum": spectrum.title, "shape": name, "mass": parts.mass}
        told |= {"effective_mass": parts.effective_mass, "mass_share": parts.share, "participation": parts.factor}
        return {"check": told | answer}

    def _shape(self, before: SavedState, after: SavedState | None) -> np.ndarray:
        """Return the displacement shape of the free blocks along the live load [m], (n_free,); ones where all move
        alike.
        """
        if after is None:
            return np.ones(len(self.masses))
        sim, d = self.sim, self.sim.model.dimension
        moved = (after.bodies.positions - before.bodies.positions)[sim.free]
        along = sim.loads.live[sim.free, :d].sum(axis=0)
        return np.asarray(product(moved, along / np.sqrt((along**2).sum())))

    def _corner(self) -> float:
        table = self.table
        return table.corner if table.corner is not None else SOILS[str(table.spectrum)][str(table.soil)][CORNER]

    def _without_mass(self) -> None:
        """Warn where dead loads beyond self-weight have no inertia under shaking."""
        sim, d = self.sim, self.sim.model.dimension
        others = sim.loads.dead[sim.free, :d].copy()
        weights = self.job.case.gravity * self.masses
        others[:, d - 1] += weights
        force = float(np.sqrt((others**2).sum(axis=1)).sum())
        if force > LEAST_FORCE * float(weights.sum()):
            self.job.warnings.append(
                f"the check leaves out the masses of dead loads, {force:.3g} N beside {weights.sum():.3g} N of "
                "weights: inertia = true gives a load that is a weight its mass"
            )

    def _nothing(self, why: str) -> dict[str, Any]:
        self.job.warnings.append(f"no check against the spectrum: {why}")
        return {}
