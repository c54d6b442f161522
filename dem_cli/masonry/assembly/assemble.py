"""Assembly of a validated case to the arrays of a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.case.base import NOTHING, KeyProblem
from dem_cli.case.wording import show, unknown_name
from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry.rotation import moments
from dem_cli.core.model.blocks import Block, corners_of
from dem_cli.core.model.bodies import BodyArrays, bodies_of
from dem_cli.core.model.first_moments import summed
from dem_cli.core.model.following_loads import FollowingLoads
from dem_cli.core.model.model import NO_COURSES, NO_PIECES, Model
from dem_cli.core.model.quadratic_modes import quadratic_loads, quadratic_modes
from dem_cli.core.model.uniform_strain import mode_loads, mode_stiffness
from dem_cli.errors import CaseError, CaseProblem, KeyPath, dotted
from dem_cli.input_limits import MOST_BLOCKS
from dem_cli.masonry.assembly import selection_checks
from dem_cli.masonry.assembly.applied_loads import applied_loads
from dem_cli.masonry.assembly.cracks import cracked
from dem_cli.masonry.assembly.drawn_blocks import drawn_block
from dem_cli.masonry.assembly.drawn_links import drawn_links, names_of
from dem_cli.masonry.assembly.elevations import imperfect_in_space
from dem_cli.masonry.assembly.ground import ground_blocks
from dem_cli.masonry.assembly.imperfect import imperfect
from dem_cli.masonry.assembly.imposed_strains import with_imposed_strains
from dem_cli.masonry.assembly.point_forces import AppliedLoad
from dem_cli.masonry.assembly.restraints import restrained
from dem_cli.masonry.assembly.selection import BlockNames, Selections
from dem_cli.masonry.structures.placement import aliases, place
from dem_cli.masonry.structures.registry import generated_blocks

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


ALONG_AXIS = 1e-9  # of a force: round-off
IMPERFECT = {2: imperfect, 3: imperfect_in_space}


class Assembly(NamedTuple):
    """Assembled model of a case with its blocks and warnings."""

    model: Model
    blocks: tuple[Block, ...]  # in the order of the model
    doubts: tuple[CaseProblem, ...] = ()  # what is allowed, but looks like a slip
    loads: tuple[AppliedLoad, ...] = ()  # table by table, where they act


def assemble(case: Case) -> Model:
    """Assemble the model of a case; raises CaseError with every problem found on the way."""
    return assembly(case).model


def assembly(case: Case) -> Assembly:
    """Assemble model, blocks and names of a case. Raises CaseError: impossible shapes, names twice, unknown blocks."""
    blocks, names = case_blocks(case)
    body = _bodies(case, blocks, names)
    selections = Selections(BlockNames(case, blocks, names, body.centroids))
    body = body._replace(selections=selections.several())
    problems = selections.problems or list(selection_checks.problems(case, body))
    if problems:
        raise CaseError(list(dict.fromkeys(problems)))
    drawn = drawn_links(case, body)
    doubts: list[CaseProblem] = []
    if case.imperfection:  # names and numbers are those of the blocks as drawn
        blocks, doubts = IMPERFECT[case.dimension](case, body, blocks)
        body = _bodies(case, blocks, names)._replace(selections=selections.several())
    loads = applied_loads(case, body)
    body = body._replace(
        links=tuple(link.laid(body.centroids) for link in drawn),
        link_names=names_of(case),
        restrained=restrained(case, body),
    )
    return Assembly(_with_loads(case, body, loads), tuple(blocks), tuple(doubts), tuple(loads))


def case_blocks(case: Case) -> tuple[list[Block], dict[str, str]]:
    """Create all blocks of a case, sorted from the lowest up and from left to right, and aliases {alias: block id}.

    Raises CaseError: impossible shapes, names twice, no blocks.
    """
    problems: list[CaseProblem] = []
    blocks: list[Block] = []
    local: dict[str, list[Block]] = {}
    for i, parameters in enumerate(case.structure):
        try:
            generated = cracked(generated_blocks(parameters, case.seed), parameters.cracks)
            _check_corners(generated)
        except ValueError as error:
            keys = error.keys if isinstance(error, KeyProblem) else ()
            problems.append(CaseProblem(("structure", i, *keys), str(error)))
            continue
        if len(blocks) + len(generated) > MOST_BLOCKS:
            problems.append(CaseProblem(("structure", i), f"more than {MOST_BLOCKS:,} blocks; no case may have more"))
            break
        local[parameters.id] = generated
        blocks += place(generated, parameters, ("structure", i), case.dimension)
    for i, table in enumerate(case.block):
        try:
            blocks.append(drawn_block(table, i, case.dimension))
        except CaseError as error:
            problems += error.problems
    if case.ground is not None and blocks and not problems:
        blocks += ground_blocks(case.ground, blocks, problems)
    problems += [*_repeated_names(blocks), *_foreign_materials(blocks, list(case.materials))]
    if not blocks and not problems:
        problems.append(CaseProblem((), "there are no blocks; give a [[structure]] or a [[block]]"))
    if problems:
        raise CaseError(problems)
    return _sorted([block.with_fields(rank=k) for k, block in enumerate(blocks)]), aliases(local)


def _check_corners(blocks: Sequence[Block]) -> None:
    """Raise ValueError where a generated block has fewer than three distinct corners."""
    flat = [block.id for block in blocks if any(len(corners_of(part)) < 3 for part in block.parts)]
    if flat:
        more = f" (and {len(flat) - 1} more)" if len(flat) > 1 else ""
        raise ValueError(f"block '{flat[0]}'{more} has no area: its sides are too different in length")


def joint_table(case: Case) -> tuple[tuple[str, ...], np.ndarray]:
    """Return the joint names and the joint between two materials, (n_materials, n_materials) int64."""
    names = tuple(case.joints)
    table = [[names.index(case.joint_between(a, b)) for b in case.materials] for a in case.materials]
    return names, np.array(table, np.int64)


def joints_in_heads(case: Case) -> np.ndarray:
    """Return the head joint of each joint by its number in the case; −1: no head joint, (n_named,) int64."""
    numbers = {name: k for k, name in enumerate(case.joints)} | {NOTHING: -1}
    return np.array([numbers[table.head or name] for name, table in case.joints.items()], np.int64)


def _repeated_names(blocks: Sequence[Block]) -> list[CaseProblem]:
    first: dict[str, Block] = {}
    problems = []
    for block in blocks:
        other = first.setdefault(block.id, block)
        if other is not block:
            message = f"the name '{block.id}' is taken by a block of {dotted(other.path)}; give another"
            problems.append(CaseProblem((*block.path, "id"), message))
            if block.path[0] == "structure":
                break  # all of its blocks would follow
    return problems


def _foreign_materials(blocks: Sequence[Block], materials: Sequence[str]) -> Iterator[CaseProblem]:
    """Report materials of imported blocks that the case does not define."""
    found: dict[tuple[KeyPath, str], list[str]] = {}
    for block in blocks:
        if block.material not in materials:
            found.setdefault((block.path, block.material), []).append(block.id)
    for (path, name), ids in found.items():
        more = f" and {len(ids) - 1} more" if len(ids) > 1 else ""
        yield CaseProblem((*path, "file"), f"block '{ids[0]}'{more}: {unknown_name('material', name, materials)}")


def _sorted(blocks: list[Block]) -> list[Block]:
    """Sort blocks from the lowest up, then along x and y, so that neighbours get close numbers."""
    corners = [corners_of(part) for block in blocks for part in block.parts]
    counts = [sum(len(corners_of(part)) for part in block.parts) for block in blocks]
    lows = np.minimum.reduceat(np.concatenate(corners), np.cumsum([0, *counts[:-1]]), axis=0)
    step = 1e-6 * (float(np.ptp(lows, axis=0).max()) or 1.0)  # against round-off within a course
    *sideways, up = lows.T
    order = np.lexsort((sideways[-1], *(np.rint(axis / step) for axis in (*sideways[-2::-1], up))))
    return [blocks[i] for i in order]


def _bodies(case: Case, blocks: Sequence[Block], names: Mapping[str, str]) -> Model:
    """Assemble the bodies of the model with their masses, without loads; names: aliases of blocks."""
    materials = list(case.materials)
    index = {name: k for k, name in enumerate(materials)}
    material = np.array([index[block.material] for block in blocks], np.int64)
    thickness = np.array([block.thickness for block in blocks])
    density = np.array([m.density for m in case.materials.values()])[material]
    bodies = bodies_of(case.dimension, [block.parts for block in blocks], density, thickness)
    bodies = _weighed(bodies, blocks)
    n, n_dof = len(blocks), case.dimension + bodies.inertias.shape[1]
    model = Model(
        **bodies._asdict(),
        block_ids=tuple(block.id for block in blocks),
        material_names=tuple(materials),
        block_material=material,
        fixed=np.array([block.fixed for block in blocks]),
        thickness=thickness,
        dead_loads=np.zeros((n, n_dof)),
        live_loads=np.zeros((n, n_dof)),
        aliases=tuple(names.items()),
        pieces=_pieces(case, blocks),
        courses=_courses(case, blocks),
        ranks=np.array([block.rank for block in blocks], np.int64),
    )
    return _with_modes(case, model)


def _pieces(case: Case, blocks: Sequence[Block]) -> np.ndarray:
    """Return stone and joint of each piece of a cracked stone, as Model.pieces; empty where no stone can crack."""
    if not any(block.crack for block in blocks):
        return NO_PIECES
    joints = {name: k for k, name in enumerate(case.joints)}
    stones = {name: k for k, name in enumerate(dict.fromkeys(block.stone for block in blocks if block.crack))}
    return np.array([(stones[b.stone], joints[b.crack]) if b.crack else (-1, -1) for b in blocks], np.int64)


def _courses(case: Case, blocks: Sequence[Block]) -> np.ndarray:
    """Return course and row of each block, as Model.courses; empty where head joints are like others."""
    if all(joint.head is None for joint in case.joints.values()) or not any(block.course for block in blocks):
        return NO_COURSES
    laid = [(block.path, block.course) for block in blocks]
    courses = {key: k for k, key in enumerate(dict.fromkeys(key for key in laid if key[1]))}
    rows = {name: k for k, name in enumerate(dict.fromkeys(["", *(block.row for block in blocks)]))}
    return np.array(
        [(courses.get(key, -1), rows[block.row]) for key, block in zip(laid, blocks, strict=True)], np.int64
    )


def _with_modes(case: Case, model: Model) -> Model:
    """Add the deformation modes of deformable blocks to the model."""
    tables = case.materials.values()
    if not any(table.strains for table in tables):
        return model
    young = np.array([table.young if table.strains else 0.0 for table in tables], float)[model.block_material]
    poisson = np.array([table.poisson for table in tables])[model.block_material]
    volumes = model.shapes.volumes * model.thickness
    stiffness = mode_stiffness(model.dimension, young, poisson, volumes, model.shapes.radii)
    stiffness[model.fixed] = 0.0
    if not any(table.bends for table in tables):
        return model._replace(mode_stiffness=stiffness)
    bends = np.array([table.bends for table in tables])[model.block_material] & ~model.fixed
    more, shapes = quadratic_modes(
        model.vertices, model.part_starts, model.part_blocks, model.thickness, np.where(bends, young, 0.0), poisson
    )
    return model._replace(mode_stiffness=np.column_stack([stiffness, more]), mode_shapes=shapes)


def _weighed(bodies: BodyArrays, blocks: Sequence[Block]) -> BodyArrays:
    """Replace the masses of blocks that have a given one, spread evenly over their parts."""
    given = [i for i, block in enumerate(blocks) if block.mass is not None]
    if not given:
        return bodies
    masses, inertias = bodies.masses.copy(), bodies.inertias.copy()
    masses[given] = [blocks[i].mass for i in given]
    inertias[given] *= (masses[given] / bodies.masses[given])[:, None]
    return bodies._replace(masses=masses, inertias=inertias)


def _with_loads(case: Case, model: Model, loads: Sequence[AppliedLoad]) -> Model:
    """Add dead loads (weight and dead applied loads) and the live loads of the analysis to the model."""
    d, dead = model.dimension, [load for load in loads if load.dead]
    pattern = getattr(case.analysis, "pattern", None)
    weight = np.zeros_like(model.dead_loads)
    weight[:, d - 1] = -model.masses * case.gravity
    free = ~model.fixed[:, None]
    live, applied = np.zeros_like(model.live_loads), list[AppliedLoad]()
    if pattern == "mass":
        live[:, :d] = -weight[:, d - 1 : d] * _direction(case)
        heavy = [load for load in dead if load.weights.any()]
        applied = [load._replace(forces=np.outer(load.weights, _direction(case))) for load in heavy]
    elif pattern == "tilt":
        turn = _quarter_turn(case, dead)
        live[:, :d] = product(weight[:, :d], turn.T)
        applied = [load._replace(forces=product(load.forces, turn.T)) for load in dead]
    elif pattern == "live":
        applied = [load for load in loads if not load.dead]
    live += _resultants(model, applied)
    dead_loads = weight + _resultants(model, dead)
    model = model._replace(
        dead_loads=dead_loads, live_loads=np.where(free, live, 0.0), following=_following(model, dead, applied)
    )
    if loads:
        model = model._replace(
            dead_first_moments=_first_moments(model, dead), live_first_moments=_first_moments(model, applied)
        )
    if not model.n_modes:
        return model
    model = model._replace(dead_mode_loads=_on_modes(model, dead), live_mode_loads=_on_modes(model, applied))
    return with_imposed_strains(case, model) if case.strain else model


def _following(model: Model, dead: Sequence[AppliedLoad], live: Sequence[AppliedLoad]) -> FollowingLoads | None:
    """Collect the follower loads, which move with their blocks. Raises CaseError: on blocks that deform."""
    acting = [*((load, True) for load in dead), *((load, False) for load in live)]
    found = [(load, is_dead) for load, is_dead in acting if load.follows is not None]
    if not found:
        return None
    if model.n_modes:
        message = "not known beside blocks that deform by themselves; 'joints' lumps them into their joints"
        raise CaseError([CaseProblem((*load.path, "follows"), message) for load, _ in found])
    blocks = np.concatenate([load.blocks for load, _ in found])
    points, forces = (np.concatenate([getattr(load, key) for load, _ in found]) for key in ("points", "forces"))
    counts = [len(load.blocks) for load, _ in found]
    are_dead, turning = ([is_dead for _, is_dead in found], [load.follows == "block" for load, _ in found])
    arms = points - model.centroids[blocks]
    return FollowingLoads(blocks, arms, forces, np.repeat(are_dead, counts), np.repeat(turning, counts))


def _direction(case: Case) -> np.ndarray:
    """Return the load direction of the analysis as a unit vector, (d,)."""
    direction = np.array(case.analysis.direction, float)
    length = np.hypot.reduce(direction)
    if length == 0.0:
        message = f"{show(case.analysis.direction)} is not allowed; a direction has a length"
        raise CaseError([CaseProblem(("analysis", "direction"), message)])
    return direction / length


def _quarter_turn(case: Case, dead: Sequence[AppliedLoad]) -> np.ndarray:
    """Return the rotation of forces for a tilt of the table by 90° towards the direction of the case, (d, d).

    About the horizontal axis square to the direction: what pulled down pulls along it. At an angle θ on the way, dead
    loads are cos θ of themselves and sin θ of themselves so turned. Raises CaseError where they are not: without a
    direction, or for a dead force along the axis, which stays what it is.
    """
    towards, up = _direction(case), np.zeros(case.dimension)
    towards[-1], up[-1] = 0.0, 1.0
    length = np.hypot.reduce(towards)
    if length == 0.0:
        way = {
            2: "towards +x or −x; the direction must have an x component",
            3: "sideways; the direction is horizontal",
        }
        raise CaseError([CaseProblem(("analysis", "direction"), f"a table tilts {way[case.dimension]}")])
    towards /= length
    for load in dead:
        along = load.forces - np.outer(product(load.forces, towards), towards) - np.outer(product(load.forces, up), up)
        if np.abs(along).max() > ALONG_AXIS * np.abs(load.forces).max():
            given = case.load[int(load.path[1])].force if load.path[0] == "load" else None
            message = "it has a part along the axis about which the table tilts"
            path = load.path if given is None else (*load.path, "force")
            raise CaseError(
                [CaseProblem(path, message if given is None else f"{show(given)} is not allowed: {message}")]
            )
    return np.outer(up, towards) - np.outer(towards, up)


def _resultants(model: Model, loads: Sequence[AppliedLoad]) -> np.ndarray:
    """Sum the applied loads to forces and moments about the centroids, (n_blocks, n_dof) [N, N m]."""
    total = np.zeros_like(model.dead_loads)
    for load in loads:
        arms = load.points - model.centroids[load.blocks]
        np.add.at(total, load.blocks, np.column_stack([load.forces, moments(arms, load.forces)]))
    return total


def _first_moments(model: Model, loads: Sequence[AppliedLoad]) -> np.ndarray:
    """Sum the first moments of applied loads about the centroids [N m], (n_blocks, 3 or 6)."""
    total = np.zeros((model.n_blocks, 3 * (model.dimension - 1)))
    for load in loads:
        arms = load.points - model.centroids[load.blocks]
        total += summed(model.n_blocks, load.blocks, arms, load.forces)
    return total


def _on_modes(model: Model, loads: Sequence[AppliedLoad]) -> np.ndarray:
    """Compute the generalised forces of point loads on the modes of deformable blocks [N], (n_blocks, m)."""
    total = np.zeros_like(model.mode_stiffness)
    for load in loads:
        arms = load.points - model.centroids[load.blocks]
        found = mode_loads(arms, load.forces, model.shapes.radii[load.blocks])
        if len(model.mode_shapes):
            found = np.column_stack([found, quadratic_loads(arms, load.forces, model.mode_shapes[load.blocks])])
        np.add.at(total, load.blocks, found)
    return np.where(model.mode_stiffness > 0.0, total, 0.0)
