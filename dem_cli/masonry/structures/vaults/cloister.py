"""Generate cloister (domical) vaults: four barrel webs that rise from four walls and meet in the diagonal planes.

Each web is half of a barrel along its wall, as long in every height as it is away from the middle: what a groin vault
leaves out of its two barrels.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from dem_cli.core.geometry.frusta import frustum, skewed
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures import arch
from dem_cli.masonry.structures.vaults.profile import arch_of
from dem_cli.masonry.structures.vaults.table import Vault
from dem_cli.masonry.structures.vaults.webs import SIDES, Bay, along_y, at_corners, bay_of, placed


def build_cloister(vault: Vault) -> list[Block]:
    """Generate the blocks of a cloister vault: fixed ones, walls from below, courses from the springing up, the
    boss.
    """
    bay = bay_of(vault)
    joints = bay.joints[len(bay.joints) // 2 :].copy()  # of half the profile, from the crown down
    joints[np.abs(joints) <= 1e-12 * bay.half] = 0.0
    blocks: list[Block] = []
    walls = _wall_faces(vault)
    foot = walls[0][walls[0][:, 1] == 0.0][:, 0] if walls else np.empty(0)
    if vault.base:
        blocks += _base(vault, bay, np.array([[foot.min(), 0.0], [foot.max(), 0.0]]) if walls else joints[-1])
    for k, face in enumerate(walls):
        blocks += _course(vault, bay, face, k - len(walls), f"wall-{k + 1}")
    courses = len(joints) - 1
    for course in range(1, courses + 1):
        upper, lower = joints[courses - course : courses - course + 2]
        blocks += _course(vault, bay, np.array([*upper, *lower[::-1]]), course, f"{course}")
    if len(bay.joints) % 2 == 0:  # a keystone in the middle of the profile
        inner, outer = (np.array([[x, x, z], [-x, x, z], [-x, -x, z], [x, -x, z]]) for x, z in joints[0].tolist())
        blocks.append(
            Block("boss", (frustum(along_y(bay)(inner), along_y(bay)(outer)),), "", course=_level(vault, courses + 1))
        )
    return blocks


def _level(vault: Vault, course: int) -> int:
    """Return the number of a course of the vault from the foot of the walls."""
    return course + (vault.piers.courses if vault.piers else 0)


def _wall_faces(vault: Vault) -> list[np.ndarray]:
    """Return the cross-sections of a wall's courses from below, as of a pier of the profile arch, each (n, 2)."""
    if vault.piers is None:
        return []
    drawn = arch.build(arch_of(vault, columns=vault.piers, base=False))
    return [np.asarray(block.parts[0]) for block in drawn if block.id.startswith("right-")]


def _course(vault: Vault, bay: Bay, face: np.ndarray, course: int, name: str) -> Iterator[Block]:
    """Yield the stones of a course with cross-section face (n, 2): of four webs and, astride, of four corners.

    course: from the springing, 1 above it, 0 and less below.
    """
    stone, astride = 2.0 * bay.half / vault.rows, vault.groins == "astride"
    heads = _heads(face, stone, course)
    ends = [*(-x for x in heads[::-1] if x > 0.0), *heads]
    places: list[np.ndarray] = [np.full(len(face), x) for x in ends]
    if not astride:
        inner = places if heads[-1] > 0.0 else []
        places = [-face[:, 0], *inner, face[:, 0]]
    material = vault.piers.material if vault.piers and course < 1 else ""
    others: dict[str, Any] = {"material": material, "course": _level(vault, course)}
    for side in SIDES:
        for number, (start, end) in enumerate(zip(places[:-1], places[1:], strict=True), 1):
            yield Block(f"{side}-{name}-{number}", (placed(_piece(face, start, end), bay, side),), **others)
    if astride:
        for corner, parts in at_corners(_piece(face, np.full(len(face), heads[-1]), face[:, 0]), bay).items():
            yield Block(f"{corner}-{name}", parts, **others)


def _heads(face: np.ndarray, stone: float, course: int) -> list[float]:
    """Return the distances of head joints from the middle of a web [m]: half a stone off in every other course.

    What is left towards the groin is at least a quarter of a stone long; the only head of a short course is at 0.
    """
    room = float(face[:, 0].min()) - stone / 4.0 * (1.0 - 1e-9)
    places = stone * (np.arange(int(max(room, 0.0) / stone) + 1) + (0.5 if course % 2 else 0.0))
    return places[places <= room].tolist() or [0.0]


def _piece(face: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return the corners of a stone of the northern web of a square bay, from start to end along x, (2 n, 3)."""
    return np.concatenate([np.column_stack([x, face]) for x in (start, end)])


def _base(vault: Vault, bay: Bay, foot: np.ndarray) -> Iterator[Block]:
    """Yield the mitred fixed blocks below the foot of the walls or the springings, from inside out (2, 2)."""
    (inner, low), (outer, high) = foot.tolist()
    face = np.array([[-inner, inner, low], [inner, inner, low], [outer, outer, high], [-outer, outer, high]])
    below = skewed(face, np.array([0.0, 0.0, -vault.thickness])).vertices
    for side in SIDES:
        yield Block(f"base-{side}", (placed(below, bay, side),), "", fixed=True)
