"""Cost of joint models: ns per contact point and step, beside plane Coulomb joints."""

from __future__ import annotations

from typing import Any

from bench.cases import KNOWN_STRUCTURES, KnownStructure
from bench.kernels import simulation, stepping
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.table import count, lines_of
from bench.timing import in_turn

PICTURES: dict[str, Any] = {}
MEASURED_CASE, QUICK_CASE = "T231", "T21 μ 0.6"
PLANE = "coulomb"
BONDED = "friction = 0.6, cohesion = 1e3, tension = 1e3"
ENERGIES = "fracture_energy_tension = 10.0, fracture_energy_shear = 10.0"
VARIANTS = {  # what the joint is -> its table; the first is the measure of all others
    PLANE: 'law = "coulomb", friction = 0.6',
    "coulomb, softening": (
        'law = "coulomb", friction = 0.6, softening = { residual = 0.5, slip_start = 1e-4, slip_length = 1e-3 }'
    ),
    "slip-degrading": 'law = "slip-degrading", friction = 0.6, residual = 0.5, slip_scale = 1e-3',
    "rate-dependent": 'law = "rate-dependent", friction = 0.6, friction_dynamic = 0.5, velocity = 0.01',
    "barton": 'law = "barton", jrc = 8.0, jcs = 5e6, residual_angle_deg = 28.0',
    "crushing": 'law = "crushing", friction = 0.6, compression = 5e6, points = 2',
    "elastic, 2 points": 'law = "elastic", points = 2',
    "mohr-coulomb, 2 points": f'law = "mohr-coulomb", {BONDED}, points = 2',
    "mohr-coulomb, 5 points": f'law = "mohr-coulomb", {BONDED}, points = 5',
    "fracture, 2 points": f'law = "fracture", {BONDED}, {ENERGIES}, points = 2',
    "fracture, 5 points": f'law = "fracture", {BONDED}, {ENERGIES}, points = 5',
    "coulomb, 5 points": 'law = "coulomb", friction = 0.6, points = 5',
    "coulomb, profile of 3 sides": 'law = "coulomb", friction = 0.6, profile = { sides = 3, aperture = 5e-5 }',
    "coulomb, profile of 5 sides": 'law = "coulomb", friction = 0.6, profile = { sides = 5, aperture = 5e-5 }',
}
MIXED = "coulomb, in one scene with mohr-coulomb"
OTHER = f'law = "mohr-coulomb", {BONDED}, points = 2'


def with_joint(known: KnownStructure, table: str, other: str = "") -> KnownStructure:
    """The same structure with another joint; `other`: one that the scene has beside it, between no blocks."""
    joints = f"joints={{dry = {{ {table} }}" + (f", other = {{ {other} }}" if other else "") + "}"
    return KnownStructure(known.name, known.file, (*known.overrides, joints), known.load, known.source)


def measure(options: BenchOptions) -> GroupResult:
    """One record per joint model and geometry; unit: ns per point and step."""
    known = KNOWN_STRUCTURES[QUICK_CASE if options.quick else MEASURED_CASE]
    rows = []
    for kinematics in ("fixed", "large"):
        for name, table in [*VARIANTS.items(), (MIXED, VARIANTS[PLANE])]:
            if "profile" in table and kinematics == "fixed":
                continue  # microrotations move the blocks
            sim = simulation(with_joint(known, table, OTHER if name == MIXED else ""), kinematics)
            rows.append((kinematics, name, sim, *stepping(sim)))
    in_turn([job for *_, job, _ in rows], options.rounds(15))
    found = GroupResult()
    for kinematics, name, sim, job, work in rows:
        times, points = [1e9 * seconds / work for seconds in job.seconds], len(sim.joints.kn)
        found.records.append(record(known.name, kinematics, name, times, "ns", points=points))
    return found


def page(records: list[Measurement]) -> list[str]:
    """The table."""
    best = {(r.axis, r.value): r.best for r in records}
    points = {(r.axis, r.value): r.found["points"] for r in records}
    rows = []
    for name in dict.fromkeys(r.value for r in records):
        cells = [count(max(n for (_, value), n in points.items() if value == name))]
        for kinematics in ("fixed", "large"):
            time, plane = best.get((kinematics, name)), best[kinematics, PLANE]
            cells += ["", "", ""] if time is None else [f"{time:.2f}", f"{time / plane:.2f}"]
            if time is not None:
                step = time * points[kinematics, name] / (plane * points[kinematics, PLANE])
                cells.append(f"{step:.2f}")
        rows.append((name, *cells))
    head = ("joints", "points", "fixed", "× coulomb", "a step", "large", "× coulomb", "a step")
    text = (
        "CPU ns per contact point and step of the wall of 231 blocks under a load that it stands, by joint model, in"
        " geometry of the start (*fixed*) and geometry that moves (*large*; profiles have no other); then the ratio to"
        " plane Coulomb joints, per point and, because joints that crack or have a profile have more points, per step."
        " Where laws are mixed every point asks which law is its own, and open points are not skipped if any law bonds."
    )
    return [text, "", *lines_of(head, rows)]
