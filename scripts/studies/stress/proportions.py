"""Mass ratios to 1e6, block sizes 1:1000, slender blocks, slivers, tiny edges, gaps and overlaps."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from studies.stress.structures import StressScene, block, drawn, explicit, ground, named, rocking_block, stack, trilith
from studies.stress.verdicts import StressRecord, load_record


def powers(short: bool, *decades: int) -> list[tuple[str, float]]:
    """Names and values of powers of ten; the first and the last where it must be short."""
    return [(f"1e{d}", 10.0**d) for d in ((decades[0], decades[-1]) if short else decades)]


def mass_ratios(short: bool) -> Iterator[StressRecord]:
    """Density of one block over that of the others: heavy on light, light on heavy, a heavy or light lintel."""
    for value, ratio in powers(short, -6, -4, -3, -2, -1, 1, 2, 3, 4, 6):
        pair = stack((1.0, 1.0), (0.25, 0.25), (2000.0, 2000.0 * ratio), 0.3)
        yield load_record("mass ratio", replace(pair, name="two blocks that slide"), value)
        tower = stack((0.5, 0.5, 0.5), (0.5, 0.5, 0.5), (2000.0, 2000.0 * ratio, 2000.0), 1.0)
        yield load_record("mass ratio", replace(tower, name="tower, middle block"), value)
        tower = stack((0.5, 0.5), (1.0, 0.2), (2000.0, 2000.0 * ratio), 1.0)
        yield load_record("mass ratio", replace(tower, name="tower, top block"), value)
        yield load_record("mass ratio", replace(trilith(lintel=ratio), name="trilith, lintel"), value)


def size_ratios(short: bool) -> Iterator[StressRecord]:
    """Small blocks on large ones and large ones on small ones, 1:10 to 1:1000 and beyond."""
    for value, ratio in powers(short, 1, 2, 3, 4):
        small = stack((1.0, 1.0 / ratio), (0.5, 0.5 / ratio), (2000.0, 2000.0), 0.4)
        yield load_record("block sizes", replace(small, name="small block on a large one"), value)
        small = stack((1.0, 0.25 / ratio), (1.0, 1.0 / ratio), (2000.0, 2000.0), 1.0)
        yield load_record("block sizes", replace(small, name="small block that rocks on a large one"), value)
        low = trilith(foot=0.4 / ratio, height=2.0 / ratio)
        yield load_record("block sizes", replace(low, name="lintel on small columns"), value)


def slender(short: bool) -> Iterator[StressRecord]:
    """Height over width of one block, of the middle blocks of a stack of slabs, and of tall piers."""
    for value, ratio in powers(False, *((1, 2) if short else (1, 2, 3, 4))):
        yield load_record("slender blocks", replace(rocking_block(1.0 / ratio), name="rocking needle"), value)
        slab = stack((1.0,), (1.0 / ratio,), (2000.0,), 0.4)
        yield load_record("slender blocks", replace(slab, name="sliding slab"), value)
        slabs = stack((1.0,) * 5, (1.0 / ratio,) * 5, (2000.0,) * 5, 0.4)
        yield load_record("slender blocks", replace(slabs, name="five slabs"), value)
        mortar = stack((0.5,) * 3, (1.0, 1.0 / ratio, 1.0), (2000.0,) * 3, 1.0)
        yield load_record("slender blocks", replace(mortar, name="thin slab between two blocks"), value)


def chamfered(cut: float) -> StressScene:
    """A rocking block 0.5 × 1 m whose right toe is cut off under 45°."""
    corners = np.array([[0, 0], [0.5 - cut, 0], [0.5, cut], [0.5, 1], [0, 1]], float)
    area = 0.5 - 0.5 * cut**2
    moment = np.array([0.125, 0.25]) - 0.5 * cut**2 * np.array([0.5 - cut / 3, cut / 3])
    x, y = moment / area
    return drawn("tiny edge at the toe", [ground(1.0), block("b", corners)], (0.5 - cut - x) / y, 1.0)


def wedge(thickness: float) -> StressScene:
    """A block on a wedge that thins out to a point: both slide on the ground at μ, before the block climbs it."""
    blocks = [
        ground(2.0),
        block("wedge", [(0, 0), (1, 0), (1, thickness)]),
        block("b", [(0, 0), (1, thickness), (1, 0.5), (0, 0.5)]),
    ]
    return drawn("block on a sliver", blocks, 0.3, 0.3)


def slivers(short: bool) -> Iterator[StressRecord]:
    """Edges and wedges of 1e-2 to 1e-6 of a block."""
    for value, size in powers(short, -2, -3, -4, -5, -6):
        yield load_record("slivers and tiny edges", chamfered(size), value)
        yield load_record("slivers and tiny edges", wedge(size), value)


def shifted(scene: StressScene, size: float, sign: float) -> StressScene:
    """Every joint opened (sign 1) or overlapping (sign −1) by half to one and a half of `size` [m], at random."""
    scene = explicit(scene)
    rng, blocks = np.random.default_rng(1), copy.deepcopy(scene.tables["block"])
    lows = [np.vstack(b.get("parts") or [b["vertices"]]).min(axis=0) for b in blocks]
    bottoms = [round(float(low[1]), 9) for low in lows]
    levels, course = sorted(set(bottoms)), {}
    for i in np.lexsort((np.array(lows)[:, 0], bottoms)):
        if blocks[i].get("fixed"):
            continue
        rank = np.array([course.setdefault(bottoms[i], 0), levels.index(bottoms[i])])
        course[bottoms[i]] += 1
        move = sign * size * (rank - rng.uniform(0.0, 0.5, 2))
        parts = [(np.array(part) + move).tolist() for part in blocks[i].get("parts") or [blocks[i]["vertices"]]]
        blocks[i] = {key: value for key, value in blocks[i].items() if key != "vertices"} | {"parts": parts}
    return replace(scene, tables={**scene.tables, "block": blocks})


HEIGHTS = {"slide": 0.5, "column": 0.0175, "wall 0.6": 0.0175, "wall 0.75": 0.0175, "trilith": 2.0}


def gaps(short: bool) -> Iterator[StressRecord]:
    """Random gaps or overlaps of 1e-8 to 1e-2 of the height of a block."""
    scenes = named()
    for name in ("column",) if short else HEIGHTS:
        for value, share in powers(short, -8, -7, -6, -5, -4, -3, -2):
            for what, sign in (("gaps", 1.0), ("overlaps", -1.0)):
                moved = shifted(scenes[name], share * HEIGHTS[name], sign)
                yield load_record(f"initial {what}", moved, value)
