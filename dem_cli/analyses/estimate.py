"""Estimate a run for `dem check`: joints, stiffness, kinematics, time step; nothing is solved.

Only the kernels of detection run here; the stepping loop is not compiled.
"""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.analyses.estimate_cost import cost_of
from dem_cli.analysis_kinds import kind_of
from dem_cli.core.engine.automatic_stiffness import needed_ratio, ratio_of, static_ratio
from dem_cli.core.engine.kinematics import live_scale, open_gaps_doubt, why_moving
from dem_cli.core.engine.measures import shares_of_blocks
from dem_cli.core.engine.properties import integrates_with, joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.links.matrices import each
from dem_cli.core.links.registry import LINKS
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import largest_structure, stiffness_scale
from dem_cli.masonry.assembly.solver_request import solver_request

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

Rows = list[tuple[str, str]]
LIBRARIES = 250e6  # bytes of a run of a few blocks: Python, compiled code, what is imported
STATES = 15  # of the structure, that an analysis holds: highest equilibrium, failure, points of a curve
COMPILING = 700e6  # bytes while the loops of time histories in space are compiled, once
LARGE = "the load is raised from there, and may be “at least …, not above …”"  # of a structure that is large
SOFTER = DEFAULT.load_search.softer
BED = np.cos(np.pi / 4)  # a bed joint has its normal within 45° of the vertical


def describe(case: Case, model: Model) -> Rows:
    """Describe joints, stiffness and cost of a run: label and text of each line of `dem check`."""
    if kind_of(case.analysis.kind).shakes:
        return _shaking(case, model)
    request = solver_request(case)
    tilting = request.analysis.tilting
    scale = 1.0 if tilting else live_scale(model)

    def simulation(kinematics: str, ratio: float) -> Simulation:
        properties = joint_properties(request, model, ratio, integrates=integrates_with(request, kinematics))
        sim = Simulation(model, law_of(request), properties, kinematics, scale, tilting, DEFAULT)
        sim.use(1.0)  # masses at the limit of stability
        return sim

    wanted = case.analysis.kinematics
    moving = _visible(case) if wanted != "fixed" else None
    moving = why_moving(request, model) if moving is None else moving
    kinematics = "fixed" if moving is None else "large"
    sim = simulation(kinematics, _ratio(case, model, kinematics))
    needed = ratio_of(sim) if moving is None else needed_ratio(sim, getattr(case.analysis, "resolution", None))
    sim = sim if needed == ratio_of(sim) else simulation(sim.kinematics, needed)
    return [
        *_blocks(model, case.gravity),
        *_joints(case, sim),
        *_stiffness(case, sim),
        *_kinematics(wanted, moving, model),
        ("time step", _time_step(sim)),
        *_runs(case),
        *_path(case, sim),
        *_beside(case, sim),
        *cost_of(case, sim, _of_property(sim)),
        ("memory", _memory(sim)),
        ("load", _load(case, model)),
        *_links(model),
        ("monitors", _monitors(case)),
    ]


def _links(model: Model) -> Rows:
    """Describe ties and bars: connected blocks, length, stiffness and strength."""
    ids = (*model.block_ids, "a fixed point")  # FIXED_POINT is -1
    return [
        (f"{LINKS[link.kind].word} {name}", link.words(number, ids))
        for link, number, name in each(model.links, model.link_names)
    ]


def _shaking(case: Case, model: Model) -> Rows:
    from dem_cli.analyses.estimate_shaking import describe_shaking
    from dem_cli.core.dynamics.history import damping_of_start, shaken
    from dem_cli.core.dynamics.rocking_stiffness import rocking_stiffness

    request = solver_request(case)
    chosen = rocking_stiffness(request, model, DEFAULT)
    settings = chosen.applied(DEFAULT)
    sim = shaken(request, model, damping_of_start(request, model, settings), settings=settings)
    return [
        *_blocks(model, case.gravity),
        *_joints(case, sim),
        *_stiffness(case, sim),
        *describe_shaking(case, request, sim, chosen.automatic),
        ("memory", _memory(sim)),
        *_links(model),
        ("monitors", _monitors(case)),
    ]


def _ratio(case: Case, model: Model, kinematics: str) -> float:
    """Return kn·h/W of "auto" joints at the start of the run."""
    if case.analysis.kind == "settlement":
        from dem_cli.analyses.settlement import stiffness_ratio as of_settlement

        return of_settlement(model, DEFAULT.stiffness.settlement_overlap)
    return static_ratio(model, kinematics, DEFAULT.stiffness)


def _blocks(model: Model, gravity: float) -> Rows:
    """Describe weight and extreme sizes of the movable blocks."""
    free = np.flatnonzero(~model.fixed)
    if not len(free):
        return [("weight", "0 N: no block can move")]
    masses = model.masses[free]
    rows = [("weight", f"{masses.sum() * gravity:.6g} N (free blocks)")]
    for label, i in (("smallest block", free[_largest(-masses)]), ("largest block", free[_largest(masses)])):
        rows.append((label, f"'{model.block_ids[i]}', {model.masses[i]:.4g} kg"))
    return rows


def _largest(values: np.ndarray) -> int:
    """Return the index of the first of the largest values; round-off does not choose between equal ones."""
    top = values.max()
    return int(np.flatnonzero(values >= top - 1e-9 * abs(top))[0])


def _joints(case: Case, sim: Simulation) -> Rows:
    """Describe the number and kinds of joints; a joint is a pair of faces."""
    number = len(sim.joints.blocks)
    near = "" if sim.kinematics == "fixed" else " (with faces that may meet)"
    rows = [("joints", f"{number:,}{near}, {sim.first_points:,} contact points")]
    named = sim.properties.between(sim.model, sim.joints.blocks)
    bed = np.abs(sim.joints.frames[sim.joints.starts[:-1], sim.model.dimension - 1]) > BED
    for k, name in enumerate(sim.properties.names):
        here = named == k
        count = int((here & bed).sum())
        text = f"{count:,} bed joints, {int(here.sum()) - count:,} others"
        rows.append((f"joint {name}", text + _points(case, sim, k)))
    return rows


def _points(case: Case, sim: Simulation, named: int) -> str:
    """Describe the contact points of a plane joint, or the integration of its pressure."""
    table, layout = case.joints[sim.properties.names[named]], sim.properties.layouts[named]
    if sim.integrates and sim.joints.integrated[sim.properties.between(sim.model, sim.joints.blocks) == named].any():
        return ", pressure integrated over the faces"
    if table.points is not None or layout is None or layout.sides is not None or not table.bends:
        return ""
    why = "kn is given" if table.kn != "auto" else "blocks deform"
    return f", {layout.points} contact points each (auto): {why}, so that bending counts"


def _stiffness(case: Case, sim: Simulation) -> Rows:
    """Describe the joint stiffness in effect, and kn·h/W (h: smallest edge, W: mean block weight over its joint)."""
    scale = stiffness_scale(sim.model)
    rows = []
    for name, kn, ks in zip(sim.properties.names, sim.properties.kn, sim.properties.ks, strict=True):
        table = case.joints[name]
        given = " and ".join(key for key in ("kn", "ks") if getattr(table, key) == "auto")
        origin = f", {given} chosen (auto)" if given else ""
        rows.append((f"stiffness {name}", f"kn {kn:.4g} Pa/m, ks {ks:.4g} Pa/m, kn·h/W {kn / scale:.3g}{origin}"))
    return rows + _deformation(case, sim)


def _deformation(case: Case, sim: Simulation) -> Rows:
    """Describe deformable materials, and the compliance that they add to the joints."""
    rows, properties, joints = [], sim.properties, sim.joints
    for name, material in case.materials.items():
        young, shear = material.moduli
        if np.isfinite(young):
            rows.append((f"blocks {name}", f"deform, lumped into their joints: E {young:.4g} Pa, G {shear:.4g} Pa"))
    if properties.compliance is None or not len(joints.blocks):
        return rows
    named, shares = properties.between(sim.model, joints.blocks), shares_of_blocks(sim, properties.compliance)
    together = properties.stiffness_of(named, sim.geometry.faces)[0]
    for k, name in enumerate(properties.names):
        here = (named == k) & (shares > 0.0)
        if here.any():
            rigid = not np.isfinite(shares[here]).all()  # kn = "auto": then all joints of this name are
            share = "that of the blocks, on rigid joints" if rigid else f"kn h/E {_range(shares[here])}"
            rows.append((f"with blocks {name}", f"kn {_range(together[here])} Pa/m, {share}"))
    return rows


def _range(values: np.ndarray) -> str:
    """Format one number, or the smallest and the largest."""
    low, high = f"{values.min():.4g}", f"{values.max():.4g}"
    return low if low == high else f"{low} to {high}"


def _visible(case: Case) -> str | None:
    """Return the reason why blocks move visibly before failure; None: they do not."""
    if getattr(case.analysis, "control", "load") == "displacement":
        return "the live load is moved as far as the case says"
    return kind_of(case.analysis.kind).moves or None


def _kinematics(wanted: str, moving: str | None, model: Model) -> Rows:
    """Describe the kinematics, fixed or moving geometry, and the gaps that stay open where it is fixed."""
    doubt = open_gaps_doubt(model) if moving is None else None
    gaps = [] if doubt is None else [("gaps", doubt)]
    if moving:
        text = f"large: {moving}"
    elif wanted != "auto":
        text = f"{wanted} (as the case says)"
    else:
        closed = "no gap may close" if gaps else "all joints are closed"
        text = f"fixed (auto): {closed}, and the geometry of the start is exact for a failure load"
    return [("kinematics", text), *gaps]


def _time_step(sim: Simulation) -> str:
    """Describe the pseudo-time step, and the joint that would limit a step with real masses."""
    joints, model = sim.joints, sim.model
    if not len(joints.kn):
        return "1 (quasi-static); there are no joints"
    inverse = sim.loads.inverse_masses[:, 0]
    ratio = np.where(model.fixed, 0.0, 1.0 / np.where(inverse > 0.0, inverse, 1.0)) / model.masses
    block = _largest(ratio)
    owner = joints.owners
    touching = np.flatnonzero((joints.blocks[owner] == block).any(axis=1))
    text = "1 (quasi-static, fictitious masses: no block limits it)"
    if not len(touching):
        return text
    stiffest = owner[touching[_largest(np.maximum(joints.kn, joints.ks)[touching])]]
    other = joints.blocks[stiffest][joints.blocks[stiffest] != block][0]
    # The fictitious mass is the one whose critical step is 1, and that step goes with the root of the mass.
    real = 1.0 / np.sqrt(ratio[block])
    names = f"'{model.block_ids[block]}' on '{model.block_ids[other]}'"
    return f"{text}; with real masses {names} would limit it to {real:.2g} s"


def _runs(case: Case) -> Rows:
    """Describe the varied parameter and number of runs of a safety analysis."""
    if case.analysis.kind != "safety":
        return []
    from dem_cli.analyses.ensembles.static_values import expected, scale_of

    scale, (fewest, most) = scale_of(case, DEFAULT.safety), expected(case)
    named = "F" if case.analysis.of_strength else case.analysis.vary
    return [("runs", f"{fewest} to {most}, {named} between {scale.low:g} and {scale.high:g}")]


def _path(case: Case, sim: Simulation) -> Rows:
    """Describe the path-following search for the failure load of a large structure, without proof of failure."""
    d, blocks = sim.model.dimension, largest_structure(sim.joints.blocks, sim.model.fixed)
    if case.analysis.kind != "pushover" or not DEFAULT.limit.too_large(blocks, d):
        return []
    if sim.kinematics != "fixed" or sim.law.bonded or sim.properties.rough or sim.links or case.analysis.step:
        return []
    way = "its path" if DEFAULT.limit.of_path(blocks, d) is DEFAULT.limit else "a smoothed path"
    return [("path", f"one structure of {blocks:,} blocks: {way} leads next to failure, in a minute or two; {LARGE}")]


def _beside(case: Case, sim: Simulation) -> Rows:
    """Describe second load histories that a pushover computes beside its failure load; its cost includes them."""
    d, blocks = sim.model.dimension, largest_structure(sim.joints.blocks, sim.model.fixed)
    if case.analysis.kind != "pushover" or not blocks:
        return []
    if sim.kinematics != "fixed":
        softer = "" if sim.properties.given else f"the same loads once more on joints {SOFTER:g} times as soft"
        return [("beside it", softer)] if softer else []
    if sim.law.bonded or sim.properties.rough or DEFAULT.limit.too_large(blocks, d):
        return []
    said = "the path of joints that do not dilate where limit analysis leaves the load open"
    if d == 2 and blocks >= DEFAULT.implicit_history.blocks and not case.analysis.step:
        said = "where friction takes part in the bound: an implicit history from gravity to failure"
        said += ", and a path" if blocks <= DEFAULT.warm_start.beside_implicit else ""
    return [("beside it", f"{said}; where two histories differ, the load is raised again in small steps")]


def _memory(sim: Simulation) -> str:
    """Estimate the peak memory of a run: libraries and the states of the structure that an analysis keeps."""
    saved = sim.save()
    state = len(pickle.dumps(saved, 5))
    whole, each = 1e-6 * (LIBRARIES + STATES * state), 1e-6 * state
    size = f"{each:.2g}" if each < 10.0 else f"{each:,.0f}"
    basis = f"{1e-6 * LIBRARIES:.0f} MB, {STATES} states of the structure of {size} MB"
    return f"some {whole:,.0f} MB ({basis}); up to {1e-6 * COMPILING:.0f} MB where kernels are compiled first"


def _of_property(sim: Simulation) -> bool:
    """Test whether joints have a given stiffness or profile, which moving geometry takes into account."""
    return sim.properties.given or sim.properties.rough


def _load(case: Case, model: Model) -> str:
    """Describe the loads that the multiplier λ scales."""
    pattern = getattr(case.analysis, "pattern", None)
    if pattern is None:
        moved = f", {len(case.settlement)} support(s) moved" if case.settlement else ""
        return f"dead loads only{moved}"
    forces = model.live_loads[:, : model.dimension].sum(axis=0) + 0.0
    total = f"[{', '.join(f'{force:.4g}' for force in forces)}] N"
    what = {
        "mass": f"λ × weight of each block along {list(case.analysis.direction)}",
        "live": "λ × live loads",
        "tilt": f"table turned by atan λ towards {_side(case.analysis.direction[:-1])}",
    }[pattern]
    return f"{pattern}: {what}; {total} at λ = 1"


def _side(sideways: Sequence[float]) -> str:
    """Describe the direction in which a table tilts: +x, −y, or a horizontal direction."""
    along = [i for i, part in enumerate(sideways) if part != 0.0]
    if len(along) == 1:
        return f"{'+' if sideways[along[0]] > 0.0 else '−'}{'xy'[along[0]]}"
    return str(list(sideways))


def _monitors(case: Case) -> str:
    texts = [f"{' '.join(filter(None, (m.quantity, m.component)))} of '{m.place}'" for m in case.monitor]
    return ", ".join(texts) if texts else "none"
