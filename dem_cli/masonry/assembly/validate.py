"""Validate the geometry: errors that stop a run, and oddities that only give a warning."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.case.wording import show, unknown_name
from dem_cli.core.arithmetic import functions
from dem_cli.core.contact.detect import block_shape, find_joints, world_corners
from dem_cli.core.contact.gaps import CLOSING_GAP, joined, joint_reach
from dem_cli.core.contact.geometry import geometry_of
from dem_cli.core.contact.layout import PointLayout
from dem_cli.core.contact.start import TOUCHING_GAP
from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.crowding import crowd
from dem_cli.core.geometry.parts import shapes_of
from dem_cli.core.geometry.rotation import unturned
from dem_cli.core.links.matrices import each
from dem_cli.core.links.registry import LINKS
from dem_cli.core.model.block_measures import median
from dem_cli.core.model.blocks import Block
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import block_at, undeformed
from dem_cli.core.model.scales import smallest_edge
from dem_cli.core.model.section_cuts import drift_ends, section_cut
from dem_cli.errors import CaseProblem
from dem_cli.masonry.assembly.assemble import joint_table, joints_in_heads
from dem_cli.masonry.assembly.place_notes import NOTES

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

DEEPEST_OVERLAP = 1e-6  # of the smaller block: deeper is a mistake
SLIVER_WIDTH = 1e-3  # width over length of a block
SIZE_RATIO = 1e3  # largest over smallest free block
MASS_RATIO = 1e6  # heaviest over lightest free block
REMOTE_STRUCTURE = 1e8  # distance from the origin over the size of a typical free part
SHOWN_MISTAKES = 5  # mistakes of one sort that are reported one by one


LIGHTEST = 1e-150  # kg, kg m2: of smaller masses and inertias the squares, and what is divided by them, are no numbers
NO_SIZE = {  # what is said of a part that is flat
    2: "has no area, or its corners run clockwise",
    3: "has no volume, or its faces look inwards",
}


class Neighbours(NamedTuple):
    """Pairs of convex parts that touch, overlap or nearly touch, whatever block they belong to."""

    parts: np.ndarray  # (n, 2)
    blocks: np.ndarray  # (n, 2)
    separation: np.ndarray  # negative: overlap [m], (n,)
    scale: np.ndarray  # size of the smaller one of the two [m], (n,)


def problems(case: Case, model: Model, blocks: Sequence[Block]) -> list[CaseProblem]:
    """Report every error of the geometry; `blocks` in the order of the model."""
    found = shape_problems(model, blocks)
    if found:
        return found
    found = crowd_problems(model, blocks)
    if found:
        return found
    near = _neighbours(model)
    note = " (with the errors of [[imperfection]])" if case.imperfection else ""
    found = overlap_problems(model, blocks, near, note) + compound_problems(model, blocks, near)
    found += monitor_problems(case, model) + profile_problems(case, model)
    if not model.fixed.any():
        path = ("structure", 0) if case.structure else ("block", 0)
        message = "no block is fixed, everything would fall; give a structure a base or a block fixed = true"
        return [*found, CaseProblem(path, message)]
    return found + support_problems(model, blocks, near)


def monitor_problems(case: Case, model: Model) -> list[CaseProblem]:
    """Report monitors of missing blocks, joints or links, and reaction monitors of blocks that nothing restrains."""
    low, high = (limit(undeformed(model), axis=0).round(6).tolist() for limit in (np.min, np.max))
    return (
        link_problems(case, model)
        + shared_problems(case, model)
        + held_problems(case, model)
        + cut_problems(case, model)
        + [
            CaseProblem(
                ("monitor", i, "point"),
                f"there is no block at {list(monitor.point)}; the structure lies between {low} and {high}",
            )
            for i, monitor in enumerate(case.monitor)
            if monitor.point is not None and block_at(model, np.array(monitor.point)) is None
        ]
    )


def link_problems(case: Case, model: Model) -> list[CaseProblem]:
    """Report monitors of missing ties and bars or beyond the end of a bar, and names used twice."""
    found, links = list[CaseProblem](), list(each(model.links, model.link_names))
    for i, monitor in enumerate(case.monitor):
        for key, name in (("tie", monitor.tie), ("bar", monitor.bar)):
            known = {there: link for link, _, there in links if LINKS[link.kind].word == key}
            if name is not None and name not in known:
                found.append(CaseProblem(("monitor", i, key), unknown_name(key, name, list(known))))
        long = next((link.length(k) for link, k, name in links if name == monitor.bar), math.inf)
        if monitor.at is not None and monitor.at > long * (1.0 + 1e-9):
            message = f"{show(monitor.at)} is not allowed; bar {show(monitor.bar)} is {long:.6g} m long"
            found.append(CaseProblem(("monitor", i, "at"), message))
    paths = [(key, i, "id") for key in LINKS for i in range(len(getattr(case, key)))]
    names = model.link_names
    first = {name: k for k, name in reversed([*enumerate(names)])}
    twice = [(path, name) for k, (path, name) in enumerate(zip(paths, names)) if first[name] < k]
    return found + [CaseProblem(path, f"{show(name)} is used twice; give another") for path, name in twice]


def held_problems(case: Case, model: Model) -> list[CaseProblem]:
    """Report reaction monitors of blocks that are neither fixed nor restrained."""
    return [
        CaseProblem(
            ("monitor", i, "quantity"),
            f"{show(monitor.quantity)} is not allowed of {monitor.said}: none of it is fixed or has a [[restraint]]",
        )
        for i, monitor in enumerate(case.monitor)
        if monitor.of_what_holds and not len(model.held_among(monitor.selected))
    ]


def cut_problems(case: Case, model: Model) -> list[CaseProblem]:
    """Report cut monitors that are no line or plane polygon, cross no joint, or end outside the blocks."""
    found, joints = list[CaseProblem](), None
    for i, monitor in enumerate(case.monitor):
        if monitor.cut is None:
            continue
        path = ("monitor", i, "cut")
        try:
            cut = section_cut(monitor.cut)
        except ValueError as error:
            found.append(CaseProblem(path, str(error)))
            continue
        if monitor.height is not None:
            ends = [end for end in drift_ends(monitor.cut, monitor.height) if block_at(model, end) is None]
            found += [
                CaseProblem((*path[:2], "height"), f"there is no block at {end.round(6).tolist()}, where it ends")
                for end in ends
            ]
            continue
        if joints is None:
            from dem_cli.core.contact.between import StartJoints

            joints = StartJoints(model).faces
        sums = np.add.reduceat(joints.shares[:, None] * joints.on_first, joints.starts[:-1], axis=0)
        middles = sums / np.add.reduceat(joints.shares, joints.starts[:-1])[:, None] if len(sums) else sums
        if not cut.passes(model.centroids, joints.blocks, middles).any():
            message = (
                "passes through no joint: blocks are on the side of their centroid, and the middle of a joint between"
            )
            found.append(CaseProblem(path, f"{message} both sides lies across the cut"))
    return found


def shared_problems(case: Case, model: Model) -> list[CaseProblem]:
    """Report monitors of the joint between two blocks that share none."""
    wanted = [(i, monitor.between) for i, monitor in enumerate(case.monitor) if monitor.between is not None]
    if not wanted:
        return []
    from dem_cli.core.contact.between import StartJoints

    joints, blocks, found = StartJoints(model), model.numbers, []
    for i, (a, b) in wanted:
        near = joints.neighbours(blocks[a])
        if blocks[b] not in near:
            message = f"'{a}' and '{b}' share no joint at the start"
            listed = ", ".join(f"'{model.block_ids[k]}'" for k in near) or "none"
            found.append(CaseProblem(("monitor", i, "between"), f"{message}; joints of '{a}' are with: {listed}"))
    return found


def profile_problems(case: Case, model: Model) -> list[CaseProblem]:
    """Report joint profiles that are too steep, or impossible in this dimension."""
    profiles = {name: table.profile for name, table in case.joints.items() if getattr(table, "profile", None)}
    if not profiles:
        return []
    from dem_cli.core.contact.geometry import motion_of

    corners = undeformed(model)
    faces = find_joints(model, corners, CLOSING_GAP * float(model.parts.sizes.min()))
    blocks = model.part_blocks[faces.parts]
    names, by_material = joint_table(case)
    named = model.joints_between(by_material, blocks, joints_in_heads(case))
    found = []
    for name, table in profiles.items():
        layout = PointLayout(seed=case.seed, **table.ranges)
        fault = motion_of(model.dimension).profile_fault(model, faces, corners, layout, named == names.index(name))
        if fault is not None:
            found.append(CaseProblem(("joints", name, "profile", fault.key), fault.why))
    return found


def warnings(model: Model) -> list[str]:
    """Return warnings about geometry that makes a run slow or inexact without being wrong."""
    free = ~model.fixed
    if not free.any():
        return ["every block is fixed: nothing can move"]
    part = np.nonzero(free[model.part_blocks])[0]
    sizes, widths = model.parts.sizes[part], _widths(model)[part]
    names = [model.block_ids[i] for i in model.part_blocks[part]]
    block = np.nonzero(free)[0]
    return [
        *_remote(model, median(sizes)),
        *_slivers(widths / sizes, names),
        *_kinks(model),
        *_spread("size", sizes, names, SIZE_RATIO),
        *_spread("mass", model.masses[block], [model.block_ids[i] for i in block], MASS_RATIO),
    ]


def _remote(model: Model, size: float) -> list[str]:
    """Warn about coordinates so far from the origin that 16 digits cannot resolve which blocks touch.

    Solvers count coordinates from the structure (model.scales.origin_of); what the case says cannot be mended.
    """
    low, high = model.centroids.min(axis=0), model.centroids.max(axis=0)
    away = float(np.hypot.reduce(np.maximum(np.maximum(low, -high), 0.0)))
    if away <= REMOTE_STRUCTURE * size:
        return []
    from_origin = f"{away:.3g} m from {show([0] * model.dimension)}, {away / size:.1e} times the size of one"
    return [
        f"the blocks lie {from_origin}: too few digits are left to say which faces touch; "
        "shift the structure to the origin"
    ]


def _widths(model: Model) -> np.ndarray:
    """Estimate the smallest side of each part [m], (n_parts,)."""
    return shapes_of(model.vertices).widths(model.vertices, model.part_starts, model.topology)


def _slivers(slim: np.ndarray, names: Sequence[str]) -> list[str]:
    """Warn about parts whose width is tiny compared with their diagonal, (n_parts,)."""
    wrong = np.nonzero(slim < SLIVER_WIDTH)[0]
    if not wrong.size:
        return []
    worst = int(np.argmin(slim))
    more = f" (and {wrong.size - 1} more)" if wrong.size > 1 else ""
    return [f"block '{names[worst]}'{more} is a sliver (width / length = {slim[worst]:.1e}): expect tiny steps"]


def _spread(what: str, values: np.ndarray, names: Sequence[str], limit: float) -> list[str]:
    large, small = int(np.argmax(values)), int(np.argmin(values))
    ratio = values[large] / values[small]
    if ratio <= limit:
        return []
    return [f"block '{names[large]}' has {ratio:.1e} times the {what} of '{names[small]}': expect a slow run"]


def _kinks(model: Model) -> list[str]:
    """Warn about blocks on both sides of a kink so shallow that contact treats it as a plane."""
    reach = TOUCHING_GAP * smallest_edge(model)
    blocks, areas = geometry_of(model.dimension).left_out(model, undeformed(model), reach)
    if not len(blocks):
        return []
    worst = int(areas.argmax())
    a, b = (model.block_ids[i] for i in blocks[worst])
    more = f", and {len(blocks) - 1} more joints" if len(blocks) > 1 else ""
    return [
        f"'{a}' and '{b}' touch on both sides of a kink that is almost flat, and their joint is on one side only, "
        f"short of {areas[worst]:.2g} m²{more}: draw the face straight, or the kink clearly"
    ]


def shape_problems(model: Model, blocks: Sequence[Block]) -> list[CaseProblem]:
    """Report parts that have no area or are not convex, and blocks whose mass is out of range."""
    least = polygon.ROUND_OFF * functions.power(model.parts.sizes, model.dimension)
    flat = model.parts.volumes <= least
    shapes = shapes_of(model.vertices)
    bent = ~shapes.are_convex(model.vertices, model.part_starts, model.topology, model.parts.sizes) & ~flat
    found = []
    for wrong, what in ((flat, NO_SIZE[model.dimension]), (bent, "is not convex")):
        hit = sorted(set(model.part_blocks[wrong].tolist()))
        found += _first_few([(blocks[i].path, f"block '{blocks[i].id}' {what}") for i in hit])
    inertias = model.inertias.min(axis=1)
    weightless = ~(
        np.isfinite(model.masses + model.inertias.max(axis=1)) & (np.minimum(model.masses, inertias) > LIGHTEST)
    )
    if not found:
        for i in np.flatnonzero(weightless)[:1].tolist():
            message = f"block '{blocks[i].id}' has a mass of {model.masses[i]:g} kg, with which nothing can be computed"
            found.append(CaseProblem(blocks[i].path, f"{message}; its density or its size is far from any stone"))
    return found


def crowd_problems(model: Model, blocks: Sequence[Block]) -> list[CaseProblem]:
    """Report hundreds of blocks in the same place, too many to compare pairwise."""
    found = crowd(undeformed(model), model.part_starts)
    if found is None:
        return []
    first, second = (blocks[i] for i in model.part_blocks[found[:2]].tolist())
    message = f"block '{second.id}' lies where block '{first.id}' does, and so do {len(found) - 2} others at least"
    return [CaseProblem(second.path, f"{message}; blocks lie beside each other")]


def overlap_problems(model: Model, blocks: Sequence[Block], near: Neighbours, note: str = "") -> list[CaseProblem]:
    """Report overlapping blocks, the deepest first; fixed ones may overlap. `note` ends each message."""
    a, b = near.blocks.T
    wrong = (near.separation < -DEEPEST_OVERLAP * near.scale) & (a != b) & ~(model.fixed[a] & model.fixed[b])
    found: list[tuple[tuple, str]] = []
    seen, rest = set(), 0
    for k in np.nonzero(wrong)[0][np.argsort(near.separation[wrong], kind="stable")]:
        pair = tuple(sorted(near.blocks[k].tolist(), key=lambda i: (blocks[i].path[:1] == ("block",), blocks[i].path)))
        if pair in seen:
            continue
        seen.add(pair)
        if len(found) == SHOWN_MISTAKES:
            rest += 1
            continue
        first, second = (blocks[i] for i in pair)
        depth = f"{-near.separation[k]:.3g} m{NOTES[model.dimension].overlap(model, near.parts[k])}"
        found.append((second.path, f"block '{second.id}' overlaps block '{first.id}' by {depth}{note}"))
    return _first_few(found, rest)


def compound_problems(model: Model, blocks: Sequence[Block], near: Neighbours) -> list[CaseProblem]:
    """Report parts of one block that overlap or are not connected."""
    if model.n_parts == model.n_blocks:
        return []
    same = near.blocks[:, 0] == near.blocks[:, 1]
    deep = same & (near.separation < -DEEPEST_OVERLAP * near.scale)
    first_part = np.searchsorted(model.part_blocks, np.arange(model.n_blocks))
    found = []
    for k in np.nonzero(deep)[0]:
        block, depth = near.blocks[k, 0], -near.separation[k]
        p, q = near.parts[k] - first_part[block] + 1
        message = f"parts {p} and {q} of block '{blocks[block].id}' overlap by {depth:.3g} m"
        message += NOTES[model.dimension].overlap(model, near.parts[k])
        found.append((blocks[block].path, message))
    touching = same & joined(near.separation, near.scale)
    group = _components(model.n_parts, near.parts[touching])
    loose = np.unique(model.part_blocks[group != group[first_part[model.part_blocks]]])
    found += [(blocks[i].path, f"the parts of block '{blocks[i].id}' do not touch each other") for i in loose]
    return _first_few(found)


def support_problems(model: Model, blocks: Sequence[Block], near: Neighbours) -> list[CaseProblem]:
    """Report groups of blocks without a chain of touching blocks to a fixed one."""
    touching = joined(near.separation, near.scale)
    group = _components(model.n_blocks, np.concatenate([near.blocks[touching], *_tied(model)]))
    held = np.zeros(model.n_blocks, bool)
    held[group[model.fixed]] = True
    found = []
    for g in sorted(set(group[~held[group]].tolist())):
        inside = group == g
        i, j, gap = _nearest_pair(model, inside)
        others = int(inside.sum()) - 1
        also = f" and {others} more touching it" if others else ""
        message = f"nothing holds up block '{blocks[i].id}'{NOTES[model.dimension].place(model, i)}{also}"
        message += f"; the nearest other block is '{blocks[j].id}', about {gap:.3g} m away"
        found.append((blocks[i].path, message))
    return _first_few(found)


def _tied(model: Model) -> list[np.ndarray]:
    """Return the pairs of blocks that ties and bars connect; a fixed point counts as a support, (n, 2) each."""
    support = int(np.flatnonzero(model.fixed)[0])
    return [np.where(link.blocks < 0, support, link.blocks) for link in model.links]


def _neighbours(model: Model) -> Neighbours:
    corners = world_corners(block_shape(model), model.centroids, unturned(model.n_blocks, model.dimension))
    sizes = model.parts.sizes
    faces = find_joints(model.parts_alone(), corners, joint_reach(model))  # parts of one block and fixed blocks as well
    return Neighbours(faces.parts, model.part_blocks[faces.parts], faces.separation, sizes[faces.parts].min(axis=1))


def _components(n: int, pairs: np.ndarray) -> np.ndarray:
    """Label connected components: the smallest node reachable from each of n nodes through the pairs, (n,)."""
    label = np.arange(n)
    while True:
        before = label.copy()
        least = np.minimum(label[pairs[:, 0]], label[pairs[:, 1]])
        for side in (0, 1):
            np.minimum.at(label, label[pairs[:, side]], least)
        label = label[label]
        if (label == before).all():
            return label


def _nearest_pair(model: Model, inside: np.ndarray) -> tuple[int, int, float]:
    """Find the nearest block outside a group, with the lowest block inside and the distance of their boxes [m]."""
    corners = undeformed(model)
    starts = np.searchsorted(model.vertex_blocks, np.arange(model.n_blocks))
    low = np.minimum.reduceat(corners, starts, axis=0)
    high = np.maximum.reduceat(corners, starts, axis=0)
    i = int(np.nonzero(inside)[0][0])
    gaps = np.maximum(np.maximum(low - high[i], low[i] - high), 0.0)
    distance = np.where(inside, np.inf, np.hypot.reduce(gaps, axis=1))
    j = int(np.argmin(distance))
    return i, j, float(distance[j])


def _first_few(found: Sequence[tuple[tuple, str]], unsaid: int = 0) -> list[CaseProblem]:
    """Keep the first errors of a kind; the last one states how many more there are."""
    shown = [CaseProblem(path, message) for path, message in found[:SHOWN_MISTAKES]]
    rest = len(found) - SHOWN_MISTAKES + unsaid
    if rest > 0:
        last = shown[-1]
        shown[-1] = CaseProblem(last.path, f"{last.message}; and {rest} more of this sort")
    return shown
