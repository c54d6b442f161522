"""What must not matter, measured: bit by bit where nothing is rounded, else how many digits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from studies.polygons import rectangle
from studies.stress import transformations
from studies.stress.identical_bytes import differences
from studies.stress.structures import StressScene, block, explicit, named
from studies.stress.verdicts import HELD, WRONG, PushoverAnswer, StressRecord, likeness, load_record, push

Change = Callable[[StressScene], StressScene]
STRUCTURES = ("slide", "rock", "column", "trilith", "wall 0.6", "wall 0.65", "wall 0.75", "arch", "portal", "groove")
KINEMATICS = ("fixed", "large")
SIZES = {"column": 0.04, "wall 0.6": 0.04, "wall 0.65": 0.04, "wall 0.75": 0.04, "arch": 0.15, "portal": 0.08}


def compared(
    axis: str, value: str, change: Change, short: bool, structures: Sequence[str] = STRUCTURES
) -> Iterator[StressRecord]:
    """The changed scene against the unchanged one, both drawn by hand."""
    scenes = named()
    for name in ("column",) if short else structures:
        for kinematics in ("fixed",) if short else KINEMATICS:
            scene = explicit(scenes[name].having("analysis.kinematics", kinematics))
            yield load_record(axis, change(scene), value, variant=kinematics, base=push(scene))


ORDERS: dict[str, Change] = {
    "blocks in any order": transformations.blocks_in_any_order,
    "corners clockwise": transformations.corners_clockwise,
    "another first corner": transformations.corners_from_another,
    "corners in any order": transformations.corners_in_any_order,
    "model renumbered": transformations.renumbered,
}


def numbering(short: bool) -> Iterator[StressRecord]:
    """Order of blocks and of corners in the case; blocks renumbered behind the sorting of the case."""
    for value, change in ORDERS.items():
        yield from compared("numbering", value, change, short)
    scenes = named()
    for name in ("column",) if short else STRUCTURES:  # triangles instead of blocks, in two orders
        scene = transformations.cut_in_two(explicit(scenes[name]))
        yield load_record("numbering", scene, "each block in two pieces", base=push(explicit(scenes[name])))
        yield load_record(
            "numbering", transformations.pieces_in_any_order(scene), "pieces in any order", base=push(scene)
        )


def place(short: bool) -> Iterator[StressRecord]:
    """Moved by 1e3 to 1e9 blocks."""
    for decade in (3,) if short else (3, 6, 9):

        def far(scene: StressScene, decade: int = decade) -> StressScene:
            edge = min(np.ptp(np.vstack(transformations.pieces(b)), axis=0).min() for b in scene.tables["block"])
            return transformations.moved(scene, 0.77 * edge * 10.0**decade, -0.33 * edge * 10.0**decade)

        yield from compared("far from the origin", f"1e{decade} blocks", far, short)


def symmetry(short: bool) -> Iterator[StressRecord]:
    """Mirror image; structure, weight and push turned together."""
    yield from compared("mirror image", "mirrored", transformations.mirrored, short)
    for degrees in (90.0,) if short else (90.0, 180.0, 1e-3, 30.0, 137.0):
        yield from compared(
            "rotation with gravity", f"{degrees:g}°", lambda s, d=degrees: transformations.rotated(s, d), short
        )


UNITS = {"lengths": "length", "densities": "density", "gravity": "gravity"}


def units(short: bool) -> Iterator[StressRecord]:
    """Lengths, densities and gravity × 1e±3, one by one and all together; powers of two round nothing."""
    for factor in (1e3,) if short else (1e3, 1e-3):
        for what, key in UNITS.items():
            yield from compared(
                "units", f"{what} × {factor:g}", lambda s, k=key, f=factor: transformations.scaled(s, **{k: f}), short
            )
    for factor in (2.0**10,) if short else (2.0**10, 2.0**-10):
        everything = {"length": factor, "density": 1 / factor, "gravity": factor}
        yield from compared(
            "units",
            f"powers of two, 2^{np.log2(factor):+.0f}",
            lambda s, e=everything: transformations.scaled(s, **e),
            short,
        )


# -- a far block that touches nothing ----------------------------------------------------------------


def far_blocks(size: float, away: float) -> dict[str, list[dict]]:
    """Blocks beside a structure of blocks of `size`, at a distance; all stronger than the structure."""
    plate = block("far ground", rectangle(away, -size, away + 100 * size, 0.0), fixed=True)
    low = rectangle(away + size, 0.0, away + 5 * size, 0.5 * size)
    tiny = rectangle(away + size, 0.0, away + 1.005 * size, 0.001 * size)
    huge = rectangle(away + size, 0.0, away + 81 * size, 10 * size)
    return {
        "fixed, tiny": [block("far", rectangle(away, 0, away + 1e-3 * size, 1e-3 * size), fixed=True)],
        "fixed, huge": [block("far", rectangle(away, 0, away + 1e3 * size, 1e3 * size), fixed=True)],
        "free, flat": [plate, block("far", low)],
        "free, tiny": [plate, block("far", tiny)],
        "free, huge": [plate, block("far", huge)],
    }


def far(short: bool) -> Iterator[StressRecord]:
    """A block that touches nothing of the structure, in a joint law of its own where that is stronger."""
    scenes = named()
    for name in ("column",) if short else ("column", "wall 0.6", "wall 0.75", "arch", "portal"):
        for kinematics in ("fixed",) if short else KINEMATICS:
            alone = explicit(scenes[name].having("analysis.kinematics", kinematics)).having("output.frames", 2)
            base = push(alone)
            for value, blocks in far_blocks(SIZES[name], 1e3 * SIZES[name]).items():
                yield far_record(alone, base, value, blocks, kinematics)


def far_record(
    alone: StressScene, base: PushoverAnswer, value: str, blocks: list[dict], kinematics: str
) -> StressRecord:
    """Failure load and every frame of the structure itself, beside the far block."""
    material, joint = (dict(next(iter(alone.tables[key].values()))) for key in ("materials", "joints"))
    tables = {
        **alone.tables,
        "materials": {**alone.tables["materials"], "rough": material},
        "joints": {**alone.tables["joints"], "rough": {**joint, "friction": 5.0}},
        "interface": [{"between": ["rough", "rough"], "joint": "rough"}],
        "block": [
            *({"material": next(iter(alone.tables["materials"])), **b} for b in alone.tables["block"]),
            *({"thickness": alone.tables["block"][0].get("thickness", 1.0), **b, "material": "rough"} for b in blocks),
        ],
    }
    beside = replace(alone, tables=tables)
    record = load_record("far block", beside, value, variant=kinematics, base=base)
    if record.verdict != HELD:
        return record
    answer = push(beside)
    if likeness(answer, base) == "bit-identical" and not same_frames(base, answer):
        return replace(record, how="same load, other places")
    return record


def same_frames(base: PushoverAnswer, answer: PushoverAnswer) -> bool:
    """Every block of the first run has the same places, turns and velocities in the second, bit by bit."""
    if len(base.frames) != len(answer.frames) or not base.frames:
        return False
    near = base.frames[0].positions
    distance = np.abs(answer.frames[0].positions[:, None] - near[None]).max(axis=2)
    rows = distance.argmin(axis=0)
    return all(
        np.array_equal(getattr(a, key), getattr(b, key)[rows])
        for a, b in zip(base.frames, answer.frames, strict=True)
        for key in ("positions", "orientations", "velocities")
    )


# -- identical bytes ---------------------------------------------------------------------------------


def same_bytes(short: bool) -> Iterator[StressRecord]:
    """Two runs of the command in processes of their own, with other hash seeds: results.h5 and summary.json."""
    for stem in ("wall_21_mu075",) if short else ("wall_21_mu075", "arch_21", "settlement_portal"):
        differing = differences(stem)
        yield StressRecord(
            "two runs", stem, "the same case twice", WRONG if differing else HELD, f"{len(differing)} differ",
            how="bit-identical", message=", ".join(differing),
        )  # fmt: skip
