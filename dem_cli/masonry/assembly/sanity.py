"""Sanity checks of an assembled case: loads off their block or on fixed ones, soft joints, units of sizes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.case.plausibility import BlockSizes, size_doubts
from dem_cli.case.wording import show
from dem_cli.core.arithmetic import functions
from dem_cli.core.geometry.convex import distance
from dem_cli.core.model.block_measures import median
from dem_cli.core.model.blocks import Block
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import blocks_at, undeformed
from dem_cli.errors import CaseProblem
from dem_cli.masonry.assembly.assemble import joint_table
from dem_cli.masonry.structures.registry import loose_ends, unsaid
from dem_cli.masonry.structures.wall_outline import Outlined

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.masonry.assembly.point_forces import AppliedLoad

BESIDE = 0.01  # of a block's size: a load so far from it still counts as on it (errors of size, rounded coordinates)
SINKS = 0.5  # of the smallest edge: a block that is so far in another one is about to come out on its other side
HEAVY = 0.05  # dead loads over the weight: so much matters to what pushes
SLIVER = 0.25 * (1.0 - 1e-6)  # of a full block of a wall: smaller pieces are most often not meant
LIGHT = 1e-3  # live loads over the weight that are most likely in another unit
MODULUS_UNITS = {"GPa": 1e9, "MPa": 1e6, "kPa": 1e3}
STIFFNESS_UNITS = {"N/mm3": 1e9, "GPa/m": 1e9, "MPa/m": 1e6, "kN/m3": 1e3}  # others than Pa/m, and one of them in it

INSTEAD = {  # of a dead load that presses and does not push: what would
    "load": "what is a mass, such as a roof or a floor, is drawn as a block",
    "pressure": "what water or earth adds when it shakes is a pressure with kind = 'live'",
}


def problems(case: Case, model: Model) -> list[CaseProblem]:
    """Report certain mistakes: point loads far outside the structure, joints or blocks too soft for the weight."""
    return [*_far_loads(case, model), *_soft_joints(case, model), *_soft_blocks(case, model)]


def doubts(case: Case, model: Model, blocks: Sequence[Block], loads: Sequence[AppliedLoad]) -> list[CaseProblem]:
    """Collect warnings about an assembled case; `blocks` in the order of the model."""
    return [
        *size_doubts(_sizes(model, blocks)),
        *odd_loads(case, model),
        *_loads_and_weight(case, model, loads),
        *_unused_joints(case),
        *_no_heads(case, model),
        *_loose_cracks(case),
        *_loose_ends(case),
        *_unspanned(case),
        *_unsaid(case),
        *_slivers(case, model, blocks),
    ]


def _sizes(model: Model, blocks: Sequence[Block]) -> BlockSizes:
    free = np.flatnonzero(~model.fixed).tolist()
    corners = undeformed(model)[np.isin(model.vertex_blocks, free)]
    sizes = functions.power(model.shapes.volumes[free], 1.0 / model.dimension)
    return BlockSizes(
        [model.block_ids[i] for i in free],
        [blocks[i].path for i in free],
        sizes.tolist(),
        model.thickness[free].tolist(),
        median(sizes) if len(free) else 0.0,
        float(np.hypot.reduce(np.ptp(corners, axis=0))) if len(free) else 0.0,
        model.dimension,
    )


def odd_loads(case: Case, model: Model) -> Iterator[CaseProblem]:
    """Warn about loads on fixed blocks and at points outside their block."""
    surface_loads = [("pressure", *one) for one in enumerate(case.pressure)] + [
        ("fill", *one) for one in enumerate(case.fill)
    ]
    for key, i, table in surface_loads:
        if model.fixed[model.chosen(table.selected, False)].all():
            path = (key, i, "block" if table.structure is None else "structure")
            yield CaseProblem(path, f"all of {table.said} is fixed: a load on it changes nothing")
    for i, load in enumerate(case.load):
        chosen = model.chosen(load.selected, False)
        if len(chosen) and model.fixed[chosen].all():
            what = f"block {load.said}" if load.block in model.numbers else f"all of {load.said}"
            message = f"{what} is fixed: a load on it changes nothing"
            yield CaseProblem(("load", i, "block" if load.structure is None else "structure"), message)
        elif (away := _away(case, model, i, beside := BESIDE * 2.0 * model.shapes.radii[chosen[:1]].sum())) > beside:
            message = f"{show(load.at)} is {away:.3g} m off block {load.said}: an arm that turns it"
            yield CaseProblem(("load", i, "at"), message)


def _loads_and_weight(case: Case, model: Model, loads: Sequence[AppliedLoad]) -> Iterator[CaseProblem]:
    """Warn about heavy dead loads without inertia, and about live loads that are negligible beside the weight."""
    weight = float(model.masses[~model.fixed].sum()) * case.gravity
    pattern = getattr(case.analysis, "pattern", None)
    pressing = [load for load in loads if load.dead and not (pattern == "mass" and load.weights.any())]
    live = [load for load in loads if not load.dead]
    dead_force, live_force = (sum(map(_size, some)) for some in (pressing, live))
    if (pattern == "mass" or kind_of(case.analysis.kind).shakes) and dead_force > HEAVY * weight:
        pushes = "are no part of the live load" if pattern == "mass" else "have no inertia"
        message = f"dead loads of {dead_force:.3g} N beside blocks of {weight:.3g} N press, but {pushes}: "
        key = str(pressing[0].path[0])
        with_inertia = pattern == "mass" and key in ("load", "fill")
        instead = f"inertia = true gives a {key} its share" if with_inertia else INSTEAD.get(key, INSTEAD["load"])
        yield CaseProblem(pressing[0].path, message + instead)
    likely, forces = 1e3 * live_force > HEAVY * weight, [_size(load) for load in live if _size(load) > 0.0]
    if pattern == "live" and 0.0 < live_force < LIGHT * weight and likely and not all(map(_is_unit, forces)):
        message = f"live loads of {live_force:.3g} N in all beside a weight of {weight:.3g} N; did you mean kN?"
        of_load = live[0].path[0] == "load"
        yield CaseProblem((*live[0].path, "force") if of_load else live[0].path, message)


def _size(load: AppliedLoad) -> float:
    """Return the magnitude of a load's resultant [N]."""
    return math.hypot(*load.resultant.tolist())


def _slivers(case: Case, model: Model, blocks: Sequence[Block]) -> Iterator[CaseProblem]:
    """Warn about walls with pieces below a quarter of a block at ends or openings, once per wall."""
    for i, wall in enumerate(case.structure):
        if wall.kind != "wall":
            continue
        masonry = [k for k, block in enumerate(blocks) if block.course and block.path[:2] == ("structure", i)]
        own = [k for k in masonry if not (wall.core and blocks[k].id.endswith("b"))]  # not of its rubble
        shares = {k: float(model.shapes.volumes[k]) / _full_block(case, wall, blocks[k]) for k in own}
        small = [k for k in own if shares[k] < SLIVER]
        if small:
            least = min(small, key=lambda k: shares[k])
            more = f", and {len(small) - 1} more are below a quarter" if len(small) > 1 else ""
            message = f"block '{blocks[least].id}' is {shares[least]:.2g} of a full one{more}: ends and openings are "
            way = "; length in place of blocks_per_course lays none" if wall.is_plain else ""
            yield CaseProblem(("structure", i), f"{message}off the grid of blocks{way}")


def _full_block(case: Case, wall: Any, block: Block) -> float:
    """Return the volume of a full block in the course of a block of a wall, in the plane its area [m^d]."""
    k = block.course - 1
    length = wall.course_lengths[k] if k < len(wall.course_lengths) else wall.block[0]
    height = wall.course_heights[k] if k < len(wall.course_heights) else wall.block[1]
    return float(length * height * (1.0 if case.dimension == 2 else wall.thickness / wall.leaves))


def _is_unit(force: float) -> bool:
    """Test whether a force is a power of ten, a unit load that makes the multiplier the load itself."""
    return math.log10(force).is_integer()


def _unused_joints(case: Case) -> Iterator[CaseProblem]:
    """Warn about joints between no two materials: most often an [[interface]] is missing."""
    names, by_material = joint_table(case)
    within = {table.cracks.joint for table in case.structure if table.cracks is not None}
    within |= {table.head for table in case.joints.values() if table.head is not None}
    for k, name in enumerate(names):
        if not (by_material == k).any() and name not in within:
            yield CaseProblem(("joints", name), "lies between no blocks: no [[interface]] names it", at_key=True)


def _no_heads(case: Case, model: Model) -> Iterator[CaseProblem]:
    """Warn about head joint definitions where no block lies in a course, so that they have no effect."""
    for name, table in case.joints.items():
        if table.head is not None and not len(model.courses):
            message = (
                f"{show(table.head)} changes nothing: no block lies in a course; generators of walls and the like lay"
            )
            yield CaseProblem(("joints", name, "head"), f"{message} courses, [[block]] does not")


def _loose_cracks(case: Case) -> Iterator[CaseProblem]:
    """Warn about cracked stones whose joints have no tensile strength."""
    for i, table in enumerate(case.structure):
        if table.cracks is None:
            continue
        joint = case.joints[table.cracks.joint]
        if joint.law != "elastic" and not getattr(joint, "tension", None):
            message = f"joint {show(table.cracks.joint)} has no tension: the pieces of a stone are stones of their own"
            yield CaseProblem(("structure", i, "crack"), message)


def _loose_ends(case: Case) -> Iterator[CaseProblem]:
    """Warn about slanting stones at free ends, which may not stand."""
    if case.analysis.kind == "gravity":
        return
    for i, table in enumerate(case.structure):
        if key := loose_ends(table):
            value, path = table, tuple(int(part) if part.isdigit() else part for part in key.split("."))
            for part in path:
                value = value[part] if isinstance(part, int) else getattr(value, part)
            where, held = ("jambs", "dressed ones") if "jambs" in path else ("free ends", "quoins")
            message = f"{show(value)}: stones at {where} may slide out along inclined joints; see "
            message += f"first whether they stand, with analysis.kind = 'gravity'; {held} hold them"
            yield CaseProblem(("structure", i, *path), message)


def _unspanned(case: Case) -> Iterator[CaseProblem]:
    """Warn about openings of an outline that have neither lintel nor arch."""
    for i, table in enumerate(case.structure):
        if isinstance(table, Outlined) and table.outline is not None and (names := table.outline.unspanned):
            more = f" and {len(names) - 1} more have" if len(names) > 1 else " has"
            message = f"{names[0]}{more} neither lintel nor arch: stones are cut there, and bond and friction alone "
            message += "hold what is above; lintel goes over rectangular openings, openings of the case have arches"
            yield CaseProblem(("structure", i, "outline"), message)


def _unsaid(case: Case) -> Iterator[CaseProblem]:
    """Warn about assumptions of structures that the case does not state."""
    for i, table in enumerate(case.structure):
        for key, message in unsaid(table):
            yield CaseProblem(("structure", i, key), message)


def _far_loads(case: Case, model: Model) -> Iterator[CaseProblem]:
    """Report loads at points further from their block than the structure is large."""
    low, high = (limit(undeformed(model), axis=0) for limit in (np.min, np.max))
    size = np.hypot.reduce(high - low)
    for i in range(len(case.load)):
        load, away = case.load[i], _away(case, model, i, size)
        if away > size:
            message = f"{show(load.at)} is {away:.3g} m off block {load.said}; "
            message += f"the structure lies between {low.round(6).tolist()} and {high.round(6).tolist()}"
            yield CaseProblem(("load", i, "at"), message)


def _away(case: Case, model: Model, i: int, enough: float) -> float:
    """Return the distance of a load from its block [m]; 0 within it and near a corner, by `enough`."""
    load = case.load[i]
    chosen = model.chosen(load.selected, False)
    if load.at is None or load.falls or len(chosen) != 1:
        return 0.0
    number, corners, starts = chosen[0], undeformed(model), model.part_starts
    own = np.flatnonzero(model.part_blocks == number)
    near = np.concatenate([corners[starts[p] : starts[p + 1]] for p in own]) - np.array(load.at)
    if np.sqrt((near**2).sum(axis=1)).min() <= enough or number in blocks_at(model, np.array(load.at)):
        return 0.0
    return min(distance(corners[starts[p] : starts[p + 1]], np.array(load.at)) for p in own)


def _soft_joints(case: Case, model: Model) -> Iterator[CaseProblem]:
    """Report joints whose normal stiffness kn lets their blocks sink too far under self-weight."""
    names, by_material = joint_table(case)
    for k, name in enumerate(names):
        kn = case.joints[name].kn
        having = (by_material == k).any(axis=1)[model.block_material] & ~model.fixed
        if kn != "auto" and having.any():
            edge = median(model.shapes.edges[having])
            if why := _sinking(model, having, kn, edge, f"{show(kn)} Pa/m", STIFFNESS_UNITS):
                yield CaseProblem(("joints", name, "kn"), why)


def _soft_blocks(case: Case, model: Model) -> Iterator[CaseProblem]:
    """Report materials whose Young's modulus is so low that self-weight crushes their blocks."""
    for k, (name, material) in enumerate(case.materials.items()):
        young, having = material.moduli[0], (model.block_material == k) & ~model.fixed
        if math.isfinite(young) and having.any():
            edge = median(model.shapes.edges[having])
            if why := _sinking(model, having, young / edge, edge, f"{show(young)} Pa", MODULUS_UNITS):
                yield CaseProblem(("materials", name, "young"), why)


def _sinking(
    model: Model, having: np.ndarray, kn: float, edge: float, said: str, units: dict[str, float]
) -> str | None:
    """Return a message where a stiffness [Pa/m] is too small for the weight of blocks (n_blocks,) bool; None: it is
    not.

    A lower estimate: their whole weight on joints as long as they are wide together, in median smallest edges [m].
    said: the value as users gave it; units: others that may have been meant, and one of them in that of the case.
    """
    corners, d = undeformed(model), model.dimension
    plan = float(np.prod(np.ptp(corners[having[model.vertex_blocks], : d - 1], axis=0)))  # [m^(d-1)]
    weight = float(np.hypot.reduce(model.dead_loads[having, :d].sum(axis=0)))
    sinks = weight / (plan * float(model.thickness[having].mean()) * kn)
    if sinks <= SINKS * edge:
        return None
    meant = [unit for unit, factor in units.items() if sinks <= 0.01 * SINKS * edge * factor]
    hint = f"; did you mean {said.split()[0]} {' or '.join(meant)}?" if meant else ""
    why = f"{said} is too soft: blocks would sink {sinks:.3g} m into each other under their own "
    return why + f"weight, {sinks / edge:.2g} smallest edges (at most {SINKS:g}){hint}"
